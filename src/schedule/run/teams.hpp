// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"
#include "schedule/cost/case_costs.hpp"

#include <string>
#include <vector>

namespace shearwake::schedule {

/// The number of the group of each case. Cases of a group share data, for example the transfer
/// function of their medium; a case that shares none forms a separate group. Not collective.
std::vector<std::size_t> groups_of(const std::vector<const PlannedCase*>& cases,
                                   cost::CaseCosts& costs);

/// Division of the world into teams of equal size; excess ranks join the last team.
struct TeamLayout {
    int ranks_per_case = 1;
    int teams = 1;
    double seconds = 0.0; // estimated time of the sweep
    double busy = 1.0;    // average share of this time in which a team computes

    int team_of(int rank) const { return std::min(rank / ranks_per_case, teams - 1); }
};

/// The layout with the shortest time: small cases run concurrently on one rank each, large ones on
/// several. `wanted` > 0 fixes the number of ranks per case. A team has at most as many ranks as
/// the slabs can use and as the world has. The number of cases that exceed the memory of a rank is
/// minimised first.
TeamLayout choose_teams(const std::vector<const PlannedCase*>& cases, int ranks, int wanted,
                        double memory_per_rank_B, cost::CaseCosts& costs);

/// A warning if `wanted` ranks per case exceed the ranks that there are; otherwise empty.
std::string excessive_team(int wanted, int ranks);

/// ", 1 rank stays idle" for teams that have no case; otherwise empty.
std::string idle_ranks_text(const TeamLayout& layout, int ranks, std::size_t cases);

/// Positions in `cases`, longest case first, so that no long case remains at the end. Cases that
/// share a medium are adjacent, so that its transfer function is computed once.
std::vector<std::size_t> order_of_work(const std::vector<const PlannedCase*>& cases,
                                       int ranks_per_case, cost::CaseCosts& costs);

} // namespace shearwake::schedule
