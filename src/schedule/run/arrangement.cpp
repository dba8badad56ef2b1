// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/arrangement.hpp"

#include "parallel/agree.hpp"

namespace shearwake::schedule {
namespace {

/// The cases at the positions `numbers` of the plan.
std::vector<const PlannedCase*> cases_of(const Plan& plan,
                                         const std::vector<std::size_t>& numbers) {
    std::vector<const PlannedCase*> cases;
    for (const std::size_t number : numbers)
        cases.push_back(&plan.cases[number]);
    return cases;
}

Arrangement arranged(const Plan& plan, const std::vector<std::size_t>& work, int ranks, int wanted,
                     double memory_per_rank_B, cost::CaseCosts& costs) {
    Arrangement all;
    for (const std::size_t place : order_of_work(cases_of(plan, work), costs))
        all.numbers.push_back(work[place]);
    all.cases = cases_of(plan, all.numbers);
    all.layout = choose_teams(all.cases, ranks, wanted, memory_per_rank_B, costs);
    all.bundles = bundles_of(all.cases, all.layout, costs);
    return all;
}

} // namespace

Arrangement arrange(const Plan& plan, const std::vector<std::size_t>& work, int wanted,
                    double memory_per_rank_B, cost::CaseCosts& costs, const Comm& world) {
    Arrangement all;
    std::vector<long> numbers, bundles;
    on_root(world, [&] {
        all = arranged(plan, work, world.size(), wanted, memory_per_rank_B, costs);
        numbers.assign(all.numbers.begin(), all.numbers.end());
        for (const Bundle& bundle : all.bundles)
            for (const std::size_t value : {bundle.first, bundle.count})
                bundles.push_back(static_cast<long>(value));
    });
    world.broadcast(numbers);
    world.broadcast(bundles);
    const TeamLayout layout{.ranks_per_case = world.broadcast(all.layout.ranks_per_case),
                            .teams = world.broadcast(all.layout.teams),
                            .seconds = world.broadcast(all.layout.seconds),
                            .busy = world.broadcast(all.layout.busy)};
    if (world.is_root()) return all;
    all.layout = layout;
    all.numbers.assign(numbers.begin(), numbers.end());
    all.cases = cases_of(plan, all.numbers);
    for (std::size_t n = 0; n < bundles.size(); n += 2)
        all.bundles.push_back(
            {static_cast<std::size_t>(bundles[n]), static_cast<std::size_t>(bundles[n + 1])});
    return all;
}

} // namespace shearwake::schedule
