// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/arrangement.hpp"

#include "parallel/agree.hpp"
#include "schedule/run/teams.hpp"

#include <algorithm>
#include <numeric>

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
    const std::vector<const PlannedCase*> cases = cases_of(plan, work);
    all.layout = choose_teams(cases, ranks, wanted, memory_per_rank_B, costs);
    for (const std::size_t place : order_of_work(cases, all.layout.ranks_per_case, costs))
        all.numbers.push_back(work[place]);
    all.cases = cases_of(plan, all.numbers);
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

namespace {

/// Bundles are preferred to single cases only if they save this share of the time: single cases
/// balance the teams better where the estimates are in error.
constexpr double least_gain = 0.02;

/// The cases with the estimated times of a team.
struct TimedCases {
    std::vector<std::size_t> groups;
    std::vector<double> own_s, shared_s;

    double seconds(const Bundle& bundle) const {
        return std::accumulate(
            own_s.begin() + static_cast<std::ptrdiff_t>(bundle.first),
            own_s.begin() + static_cast<std::ptrdiff_t>(bundle.first + bundle.count), 0.0);
    }
};

TimedCases timed(const std::vector<const PlannedCase*>& cases, const TeamLayout& layout,
                 cost::CaseCosts& costs) {
    TimedCases all{.groups = groups_of(cases, costs), .own_s = {}, .shared_s = {}};
    for (const PlannedCase* planned : cases) {
        const cost::CaseTime expected = costs.time(planned->physics, layout.ranks_per_case);
        all.own_s.push_back(expected.own_s);
        all.shared_s.push_back(expected.shared_s);
    }
    return all;
}

/// Groups of at most `longest_s` as one bundle, before the others as single cases in their order.
std::vector<Bundle> with_whole_groups(const TimedCases& cases, double longest_s) {
    std::vector<Bundle> bundles;
    for (std::size_t first = 0; first < cases.groups.size();) {
        Bundle group{first, 1};
        while (first + group.count < cases.groups.size() &&
               cases.groups[first + group.count] == cases.groups[first])
            ++group.count;
        if (cases.shared_s[first] + cases.seconds(group) <= longest_s)
            bundles.push_back(group);
        else
            for (std::size_t n = 0; n < group.count; ++n)
                bundles.push_back({first + n, 1});
        first += group.count;
    }
    std::ranges::stable_sort(bundles, std::greater<>{},
                             [&](const Bundle& bundle) { return cases.seconds(bundle); });
    return bundles;
}

std::vector<Bundle> single(std::size_t cases) {
    std::vector<Bundle> bundles(cases);
    for (std::size_t n = 0; n < cases; ++n)
        bundles[n].first = n;
    return bundles;
}

/// The time until all teams have finished, if each takes the next bundle when it is free.
double seconds_of(const std::vector<Bundle>& bundles, const TimedCases& cases, int teams) {
    struct Team {
        double busy_s = 0.0;
        std::size_t group = static_cast<std::size_t>(-1); // whose shared data it has
    };
    std::vector<Team> all(static_cast<std::size_t>(teams));
    for (const Bundle& bundle : bundles) {
        Team& team = *std::ranges::min_element(all, {}, &Team::busy_s);
        const std::size_t group = cases.groups[bundle.first];
        if (team.group != group) team.busy_s += cases.shared_s[bundle.first];
        team.group = group;
        team.busy_s += cases.seconds(bundle);
    }
    return std::ranges::max_element(all, {}, &Team::busy_s)->busy_s;
}

} // namespace

std::vector<Bundle> bundles_of(const std::vector<const PlannedCase*>& cases,
                               const TeamLayout& layout, cost::CaseCosts& costs) {
    std::vector<Bundle> best = single(cases.size());
    if (layout.teams <= 1 || cases.empty()) return best;
    const TimedCases times = timed(cases, layout, costs);
    const double single_s = seconds_of(best, times, layout.teams);
    double best_s = (1.0 - least_gain) * single_s;
    for (const double share : {0.125, 0.25, 0.5, 1.0}) {
        std::vector<Bundle> bundles = with_whole_groups(times, share * single_s);
        const double seconds = seconds_of(bundles, times, layout.teams);
        if (!(seconds < best_s)) continue;
        best_s = seconds;
        best = std::move(bundles);
    }
    return best;
}

} // namespace shearwake::schedule
