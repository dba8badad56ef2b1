// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

} // namespace shearwake::schedule
