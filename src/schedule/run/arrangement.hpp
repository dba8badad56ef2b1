// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "problem/case/plan.hpp"
#include "schedule/cost/case_costs.hpp"

#include <cstddef>
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

/// Consecutive cases that one team computes one after the other.
struct Bundle {
    std::size_t first = 0, count = 1;
    bool operator==(const Bundle&) const = default;
};

/// Divides cases that are in the order of work into bundles, which the teams take in this order. A
/// bundle is a single case, or a complete group of cases that share data, so that only one team
/// computes this data. Groups stay together if the estimated time is shorter then. Not collective.
std::vector<Bundle> bundles_of(const std::vector<const PlannedCase*>& cases,
                               const TeamLayout& layout, cost::CaseCosts& costs);

/// The cases at the positions `numbers` of the plan.
std::vector<const PlannedCase*> cases_of(const Plan& plan, const std::vector<std::size_t>& numbers);

/// The remaining cases of a sweep in the order of work, and their division among teams. Identical
/// on all ranks.
struct Arrangement {
    std::vector<const PlannedCase*> cases; // in the order of work
    std::vector<std::size_t> numbers;      // their positions in the plan
    TeamLayout layout;
    std::vector<Bundle> bundles; // of the cases, in the order in which they start
};

/// Arranges the cases at the positions `work` of the plan. Rank 0 decides and broadcasts the
/// result, since `costs` contains measured times, which differ between ranks: teams that had
/// different orders would compute some cases twice and others never. `wanted`: see choose_teams().
/// Collective.
Arrangement arrange(const Plan& plan, const std::vector<std::size_t>& work, int wanted,
                    double memory_per_rank_B, cost::CaseCosts& costs, const Comm& world);

/// Measures the rates of the cases and of files for `plan --probe`, with a message on stderr.
/// Collective.
void probe(const std::vector<const PlannedCase*>& cases, int ranks_per_case,
           double memory_per_rank_B, cost::CaseCosts& costs, const Comm& world);

} // namespace shearwake::schedule
