// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "problem/case/plan.hpp"
#include "schedule/cost/case_costs.hpp"
#include "schedule/run/bundles.hpp"
#include "schedule/run/teams.hpp"

#include <cstddef>
#include <vector>

namespace shearwake::schedule {

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
