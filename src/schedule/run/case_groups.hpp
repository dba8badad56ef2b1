// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"
#include "schedule/cost/case_costs.hpp"

#include <vector>

namespace shearwake::schedule {

/// The number of the group of each case. Cases of a group share data, for example the transfer
/// function of their medium; a case that shares none forms a separate group. Not collective.
std::vector<std::size_t> groups_of(const std::vector<const PlannedCase*>& cases,
                                   cost::CaseCosts& costs);

} // namespace shearwake::schedule
