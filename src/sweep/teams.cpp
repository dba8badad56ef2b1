#include "sweep/teams.hpp"

#include "sweep/memory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace shearwake {
namespace {

/// What further ranks bring: measured with `shearwake bench`, 1.7 times on two ranks.
constexpr double efficiency_of_team = 0.85;

double speed_of(int ranks) {
    return ranks == 1 ? 1.0 : 1.0 + efficiency_of_team * (ranks - 1);
}

Estimate estimate_of(const PlannedCase& planned, int ranks) {
    return make_engine(planned.physics.solver)->estimate(planned.physics, ranks);
}

/// Estimates of all cases on teams of one size; equal grids have equal estimates, so that ten
/// thousand cases cost a handful of them.
std::vector<Estimate> estimates_of(const std::vector<const PlannedCase*>& cases, int ranks) {
    std::vector<Estimate> all;
    for (const PlannedCase* planned : cases)
        all.push_back(estimate_of(*planned, ranks));
    return all;
}

} // namespace

TeamLayout choose_teams(const std::vector<const PlannedCase*>& cases, int ranks, int wanted,
                        double memory_per_rank_B) {
    TeamLayout best;
    std::ptrdiff_t best_unfit = std::numeric_limits<std::ptrdiff_t>::max();
    best.seconds = std::numeric_limits<double>::infinity();
    for (int size = 1; size <= ranks; ++size) {
        if (wanted > 0 && size != std::min(wanted, ranks)) continue;
        if (wanted <= 0 && ranks % size != 0) continue;
        TeamLayout layout{.ranks_per_case = size, .teams = ranks / size};
        double longest = 0.0, work = 0.0, shared = 0.0;
        bool useful = true;
        for (const Estimate& e : estimates_of(cases, size)) {
            const double seconds = e.seconds / speed_of(std::min(size, e.useful_ranks));
            longest = std::max(longest, seconds);
            shared = std::max(shared, e.shared_seconds / speed_of(size));
            work += seconds;
            useful = useful && size <= e.useful_ranks;
        }
        if (!useful && wanted <= 0) continue;
        // What is shared is computed by every team for itself.
        layout.seconds = shared + std::max(longest, work / layout.teams);
        const auto unfit = std::count_if(cases.begin(), cases.end(), [&](const PlannedCase* c) {
            return memory_needed_B(c->physics, size) > memory_per_rank_B;
        });
        // Small teams when it is a tie.
        const bool better = unfit == best_unfit && layout.seconds < 0.99 * best.seconds;
        if (unfit > best_unfit || (unfit == best_unfit && !better)) continue;
        best_unfit = unfit;
        best = layout;
    }
    if (!std::isfinite(best.seconds)) best.seconds = 0.0;
    return best;
}

std::vector<std::size_t> order_of_work(const std::vector<const PlannedCase*>& cases) {
    struct Rank {
        double group_seconds, seconds;
        std::size_t group;
    };
    std::vector<Rank> ranks;
    std::vector<std::pair<const Case*, double>>
        groups; // a case of each medium and grid, its longest
    for (const PlannedCase* planned : cases) {
        const Case& c = planned->physics;
        const double seconds = estimate_of(*planned, 1).seconds;
        const auto same = [&](const auto& group) {
            return group.first->medium == c.medium && group.first->domain == c.domain &&
                   group.first->time == c.time &&
                   group.first->measure.depths_m == c.measure.depths_m;
        };
        auto group = std::find_if(groups.begin(), groups.end(), same);
        if (group == groups.end()) group = groups.insert(groups.end(), {&c, 0.0});
        group->second = std::max(group->second, seconds);
        ranks.push_back({0.0, seconds, static_cast<std::size_t>(group - groups.begin())});
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

} // namespace shearwake
