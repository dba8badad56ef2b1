// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"
#include "schedule/cost/case_costs.hpp"
#include "schedule/cost/learned_times.hpp"
#include "schedule/run/bundles.hpp"

#include <vector>

namespace shearwake::schedule {

/// Estimated time in s of the work that a case shares with the previous case of its team, unless
/// that case has done it. `before`: null without a previous case. Not collective.
double shared_s(const Case& c, const Case* before, int ranks, cost::CaseCosts& costs);

/// The estimates of cases that `teams` teams of `ranks` ranks compute in these bundles. Not
/// collective.
std::vector<ExpectedCase> expected_cases(const std::vector<const PlannedCase*>& cases,
                                         const std::vector<Bundle>& bundles, int ranks, int teams,
                                         cost::CaseCosts& costs);

} // namespace shearwake::schedule
