// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "problem/case/plan.hpp"
#include "schedule/cost/case_costs.hpp"
#include "schedule/run/teams.hpp"

#include <cstddef>
#include <vector>

namespace shearwake::schedule {

/// Consecutive cases that one team computes one after the other.
struct Bundle {
    std::size_t first = 0, count = 1;
    bool operator==(const Bundle&) const = default;
};

/// Divides cases that are in the order of work into bundles, which the teams take in this order. A
/// bundle is a single case, or a complete group of cases that share data (case_groups.hpp), so that
/// only one team computes this data. Groups stay together if the estimated time is shorter then.
/// Not collective.
std::vector<Bundle> bundles_of(const std::vector<const PlannedCase*>& cases,
                               const TeamLayout& layout, cost::CaseCosts& costs);

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

} // namespace shearwake::schedule
