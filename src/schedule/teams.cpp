// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/teams.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>

namespace shearwake::schedule {
namespace {

/// Largest number of cases that are considered; more do not improve the layout.
constexpr std::size_t most_samples = 256;

/// A sample of cases, spread evenly.
std::vector<const PlannedCase*> sample_of(const std::vector<const PlannedCase*>& cases) {
    if (cases.size() <= most_samples) return cases;
    std::vector<const PlannedCase*> sample;
    for (std::size_t i = 0; i < most_samples; ++i)
        sample.push_back(cases[i * (cases.size() - 1) / (most_samples - 1)]);
    return sample;
}

} // namespace

TeamLayout choose_teams(const std::vector<const PlannedCase*>& cases, int ranks, int wanted,
                        double memory_per_rank_B, cost::CaseCosts& costs) {
    TeamLayout best;
    std::ptrdiff_t best_unfit = std::numeric_limits<std::ptrdiff_t>::max();
    best.seconds = std::numeric_limits<double>::infinity();
    const std::vector<const PlannedCase*> sample = sample_of(cases);
    const double each =
        sample.empty() ? 0.0
                       : static_cast<double>(cases.size()) / static_cast<double>(sample.size());
    for (int size = 1; size <= ranks; ++size) {
        if (wanted > 0 && size != std::min(wanted, ranks)) continue;
        if (wanted <= 0 && ranks % size != 0) continue;
        TeamLayout layout{.ranks_per_case = size, .teams = ranks / size};
        const int busy = std::max(
            1, static_cast<int>(std::min(static_cast<std::size_t>(layout.teams), cases.size())));
        double longest = 0.0, work = 0.0, shared = 0.0;
        bool useful = true;
        for (const PlannedCase* planned : sample) {
            const cost::CaseCost& cost = costs.of(planned->physics);
            const double seconds = cost::seconds_on(cost, size, busy, costs.machine());
            longest = std::max(longest, seconds);
            shared = std::max(shared, cost::shared_seconds_on(cost, size, costs.machine()));
            work += each * seconds;
            useful = useful && size <= cost.useful_ranks;
        }
        if (!useful && wanted <= 0) continue;
        // Every team computes the shared data itself.
        layout.seconds = shared + std::max(longest, work / busy);
        layout.busy = layout.seconds > 0.0 ? (work / busy + shared) / layout.seconds : 1.0;
        const auto unfit = std::ranges::count_if(sample, [&](const PlannedCase* c) {
            return costs.memory_per_rank_B(c->physics, size) > memory_per_rank_B;
        });
        // Of layouts with similar times, small teams are preferred.
        const bool better = unfit == best_unfit && layout.seconds < 0.99 * best.seconds;
        if (unfit > best_unfit || (unfit == best_unfit && !better)) continue;
        best_unfit = unfit;
        best = layout;
    }
    if (!std::isfinite(best.seconds)) best.seconds = 0.0;
    return best;
}

std::string excessive_team(int wanted, int ranks) {
    if (wanted <= ranks) return "";
    return fmt::format("--ranks-per-case {} exceeds the {} rank{} of the run: a team has {}",
                       wanted, ranks, ranks == 1 ? "" : "s", ranks);
}

std::string idle_ranks_text(const TeamLayout& layout, int ranks, std::size_t cases) {
    // Excess ranks join the last team, so that only teams without a case are idle.
    if (cases >= static_cast<std::size_t>(layout.teams)) return "";
    const int idle = ranks - static_cast<int>(cases) * layout.ranks_per_case;
    return fmt::format(", {} rank{} idle", idle, idle == 1 ? " stays" : "s stay");
}

std::vector<std::size_t> order_of_work(const std::vector<const PlannedCase*>& cases,
                                       cost::CaseCosts& costs) {
    struct Rank {
        double group_seconds, seconds;
        std::size_t group;
    };
    std::vector<Rank> ranks;
    std::vector<std::pair<const Case*, double>>
        groups; // one case of each medium and grid, and the time of the longest case
    for (const PlannedCase* planned : cases) {
        const Case& c = planned->physics;
        const cost::CaseCost& cost = costs.of(c);
        // A case that shares no data forms a separate group.
        const auto same = [&](const auto& group) {
            return cost.shared_s > 0.0 && group.first->scene().medium == c.scene().medium &&
                   group.first->domain == c.domain && group.first->time == c.time &&
                   group.first->measure.depths_m == c.measure.depths_m;
        };
        auto group =
            cost.shared_s > 0.0 ? std::find_if(groups.begin(), groups.end(), same) : groups.end();
        if (group == groups.end()) group = groups.insert(groups.end(), {&c, 0.0});
        group->second = std::max(group->second, cost.compute_s);
        ranks.push_back({0.0, cost.compute_s, static_cast<std::size_t>(group - groups.begin())});
    }
    for (Rank& rank : ranks)
        rank.group_seconds = groups[rank.group].second;
    std::vector<std::size_t> order(cases.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        if (ranks[a].group != ranks[b].group) {
            if (ranks[a].group_seconds != ranks[b].group_seconds)
                return ranks[a].group_seconds > ranks[b].group_seconds;
            return ranks[a].group < ranks[b].group;
        }
        return ranks[a].seconds > ranks[b].seconds;
    });
    return order;
}

} // namespace shearwake::schedule
