// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "problem/case/plan.hpp"
#include "schedule/cost/case_costs.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace shearwake::schedule {

/// Division of the world into teams of equal size; ranks that are left over are idle.
struct TeamLayout {
    int ranks_per_case = 1;
    int teams = 1;

    /// The number of the team of a rank; `teams` for ranks that remain, which are idle.
    int team_of(int rank) const { return std::min(rank / ranks_per_case, teams); }
};

/// Positions in `cases`, most work first, so that no long case remains at the end. Cases that share
/// data are adjacent, so that a team computes these data once. Not collective.
std::vector<std::size_t> order_of_work(const std::vector<const PlannedCase*>& cases,
                                       cost::CaseCosts& costs);

/// The work of each case for a rank of a team of `ranks` ranks, in units of engines::Resources. The
/// first one of adjacent cases that share data includes their computation. Not collective.
std::vector<double> work_per_rank(const std::vector<const PlannedCase*>& cases, int ranks,
                                  cost::CaseCosts& costs);

/// The time until `teams` teams have computed cases of these lengths, without the imbalance of
/// different cases: that of the longest case, or of as many average cases as the busiest team has.
double sweep_length(const std::vector<double>& lengths, int teams);

/// The layout of cases in the order of work. `wanted` > 0 fixes the number of ranks per case.
/// Otherwise a team has the smallest number of ranks that divides the world, does not exceed the
/// rows of the grids and, in this order, lets most cases fit into the memory of a rank and needs at
/// most 5/4 of the shortest time. Not collective.
TeamLayout choose_teams(const std::vector<const PlannedCase*>& cases, int ranks, int wanted,
                        double memory_per_rank_B, cost::CaseCosts& costs);

/// A warning if `wanted` ranks per case exceed the ranks that there are; otherwise empty.
std::string excessive_team(int wanted, int ranks);

/// ", 1 rank stays idle" for teams that have no case; otherwise empty.
std::string idle_ranks_text(const TeamLayout& layout, int ranks, std::size_t cases);

/// The cases at the positions `numbers` of the plan.
std::vector<const PlannedCase*> cases_of(const Plan& plan, const std::vector<std::size_t>& numbers);

/// The remaining cases of a sweep in the order of work, and their division among teams. Identical
/// on all ranks.
struct Arrangement {
    std::vector<const PlannedCase*> cases; // in the order of work
    std::vector<std::size_t> numbers;      // their positions in the plan
    std::vector<double> work;              // see work_per_rank()
    TeamLayout layout;
    /// The position in `cases` of the first case of each portion. The teams take the portions in
    /// this order. A portion is a case, or all cases that share data if they are at most half of
    /// the work of a team.
    std::vector<std::size_t> portions;
};

/// Arranges the cases at the positions `work` of the plan. Rank 0 decides. `wanted`: see
/// choose_teams(). Collective.
Arrangement arrange(const Plan& plan, const std::vector<std::size_t>& work, int wanted,
                    double memory_per_rank_B, cost::CaseCosts& costs, const Comm& world);

} // namespace shearwake::schedule
