#pragma once

#include "model/plan.hpp"
#include "sweep/case_costs.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// The world split into teams of equal size; ranks left over join the last team.
struct TeamLayout {
    int ranks_per_case = 1;
    int teams = 1;
    double seconds = 0.0; // estimate for the whole sweep
    double busy = 1.0;    // share of that time that a team with a case works, on average

    int team_of(int rank) const { return std::min(rank / ranks_per_case, teams - 1); }
};

/// The layout that finishes the cases first: small cases side by side, each on one rank, large ones
/// on several. `wanted` > 0 fixes the ranks per case. A team never has more ranks than the slabs
/// can use, nor more than the world has. As many cases as can be must fit into a rank's memory.
TeamLayout choose_teams(const std::vector<const PlannedCase*>& cases, int ranks, int wanted,
                        double memory_per_rank_B, CaseCosts& costs);

/// Longest first, so that no long case is left for the end; cases that share a medium together, so
/// that its transfer function is computed once. Positions in `cases`.
std::vector<std::size_t> order_of_work(const std::vector<const PlannedCase*>& cases,
                                       CaseCosts& costs);

} // namespace shearwake
