// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/arrangement.hpp"

#include "base/text.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <numeric>
#include <tuple>

namespace shearwake::schedule {
namespace {

/// A smaller team is preferred to a faster one up to this ratio, since the ranks of a team wait for
/// each other.
constexpr double preferred_ratio = 1.25;
/// Largest number of cases whose memory is compared with that of a rank.
constexpr std::size_t most_samples = 256;
/// Cases that share data form one portion up to this share of the work of a team.
constexpr double largest_portion = 0.5;
/// CPU time for the resources of all cases; those that remain have the ones of a neighbour.
constexpr double most_estimating_s = 1.5;

/// Whether a case shares data with the case before it in the order of work.
bool shares_with(const engines::Resources& before, const engines::Resources& needs) {
    return !needs.shared.empty() && needs.shared == before.shared;
}

/// The number of cases, spread over the sweep, that exceed the memory of a rank.
std::size_t count_unfit(const std::vector<const PlannedCase*>& cases, int ranks,
                        double memory_per_rank_B, cost::CaseCosts& costs) {
    if (!std::isfinite(memory_per_rank_B)) return 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < cases.size(); i += cases.size() / most_samples + 1)
        if (costs.resources(cases[i]->physics, ranks).memory_per_rank_B() > memory_per_rank_B)
            ++count;
    return count;
}

} // namespace

std::vector<std::size_t> order_of_work(const std::vector<const PlannedCase*>& cases,
                                       cost::CaseCosts& costs) {
    struct Place {
        std::string group; // of the cases that share data
        double work;
    };
    std::vector<Place> places;
    std::map<std::string, double> most; // work of a case of each group
    for (const PlannedCase* planned : cases) {
        const engines::Resources& needs = costs.resources(planned->physics);
        places.push_back({needs.shared.empty() ? planned->id : needs.shared, needs.work});
        double& work = most[places.back().group];
        work = std::max(work, needs.work);
    }
    std::vector<std::size_t> order(cases.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::less<>{}, [&](std::size_t i) {
        const auto& [group, work] = places[i];
        return std::tuple(-most.at(group), group, -work);
    });
    return order;
}

std::vector<double> work_per_rank(const std::vector<const PlannedCase*>& cases, int ranks,
                                  cost::CaseCosts& costs) {
    std::vector<double> work;
    const engines::Resources* before = nullptr;
    for (const PlannedCase* planned : cases) {
        const engines::Resources& needs = costs.resources(planned->physics);
        const bool has_data = before && shares_with(*before, needs);
        work.push_back((needs.work + (has_data ? 0.0 : needs.shared_work)) /
                       std::clamp(ranks, 1, needs.useful_ranks));
        before = &needs;
    }
    return work;
}

double sweep_length(const std::vector<double>& lengths, int teams) {
    if (lengths.empty()) return 0.0;
    const auto cases = static_cast<double>(lengths.size());
    const double mean = std::accumulate(lengths.begin(), lengths.end(), 0.0) / cases;
    return std::max(std::ranges::max(lengths), mean * std::ceil(cases / teams));
}

TeamLayout choose_teams(const std::vector<const PlannedCase*>& cases, int ranks, int wanted,
                        double memory_per_rank_B, cost::CaseCosts& costs) {
    struct Choice {
        TeamLayout layout;
        std::size_t unfit = 0;
        double length = 0.0;
    };
    int useful = ranks;
    for (const PlannedCase* planned : cases)
        useful = std::min(useful, costs.resources(planned->physics).useful_ranks);
    std::vector<Choice> choices;
    for (int size = 1; size <= ranks; ++size) {
        if (wanted > 0 ? size != std::min(wanted, ranks) : ranks % size != 0 || size > useful)
            continue;
        const TeamLayout layout{.ranks_per_case = size, .teams = ranks / size};
        choices.push_back({layout, count_unfit(cases, size, memory_per_rank_B, costs),
                           sweep_length(work_per_rank(cases, size, costs), layout.teams)});
    }
    const std::size_t least_unfit = std::ranges::min(choices, {}, &Choice::unfit).unfit;
    std::erase_if(choices, [&](const Choice& choice) { return choice.unfit > least_unfit; });
    const double shortest = std::ranges::min(choices, {}, &Choice::length).length;
    return std::ranges::find_if(
               choices,
               [&](const Choice& choice) { return choice.length <= preferred_ratio * shortest; })
        ->layout;
}

std::string excessive_team(int wanted, int ranks) {
    if (wanted <= ranks) return "";
    return fmt::format("--ranks-per-case {} exceeds the {} of the run: a team has {}", wanted,
                       counted(ranks, "rank"), ranks);
}

std::string idle_ranks_text(const TeamLayout& layout, int ranks, std::size_t cases) {
    const auto busy = static_cast<int>(std::min(cases, static_cast<std::size_t>(layout.teams)));
    const int idle = ranks - busy * layout.ranks_per_case;
    if (idle == 0) return "";
    return fmt::format(", {} rank{} idle", idle, idle == 1 ? " stays" : "s stay");
}

std::vector<const PlannedCase*> cases_of(const Plan& plan,
                                         const std::vector<std::size_t>& numbers) {
    std::vector<const PlannedCase*> cases;
    for (const std::size_t number : numbers)
        cases.push_back(&plan.cases[number]);
    return cases;
}

namespace {

std::vector<std::size_t> portions_of(const Arrangement& all, cost::CaseCosts& costs) {
    const double most =
        largest_portion * std::accumulate(all.work.begin(), all.work.end(), 0.0) / all.layout.teams;
    std::vector<std::size_t> portions;
    for (std::size_t first = 0, end = 0; first < all.cases.size(); first = end) {
        const engines::Resources& needs = costs.resources(all.cases[first]->physics);
        double work = 0.0;
        do
            work += all.work[end++];
        while (end < all.cases.size() &&
               shares_with(needs, costs.resources(all.cases[end]->physics)));
        for (std::size_t n = first; n < end; ++n)
            if (n == first || work > most) portions.push_back(n);
    }
    return portions;
}

} // namespace

Arrangement arrange(const Plan& plan, const std::vector<std::size_t>& work, int wanted,
                    double memory_per_rank_B, cost::CaseCosts& costs, const Comm& world) {
    Arrangement all;
    std::vector<long> numbers, portions;
    on_root(world, [&] {
        const std::vector<const PlannedCase*> cases = cases_of(plan, work);
        costs.limit_resources(cases, most_estimating_s);
        for (const std::size_t place : order_of_work(cases, costs))
            all.numbers.push_back(work[place]);
        all.cases = cases_of(plan, all.numbers);
        all.layout = choose_teams(all.cases, world.size(), wanted, memory_per_rank_B, costs);
        all.work = work_per_rank(all.cases, all.layout.ranks_per_case, costs);
        all.portions = portions_of(all, costs);
        numbers.assign(all.numbers.begin(), all.numbers.end());
        portions.assign(all.portions.begin(), all.portions.end());
    });
    world.broadcast(numbers);
    world.broadcast(portions);
    world.broadcast(all.work);
    all.layout.ranks_per_case = world.broadcast(all.layout.ranks_per_case);
    all.layout.teams = world.broadcast(all.layout.teams);
    all.numbers.assign(numbers.begin(), numbers.end());
    all.portions.assign(portions.begin(), portions.end());
    all.cases = cases_of(plan, all.numbers);
    return all;
}

} // namespace shearwake::schedule
