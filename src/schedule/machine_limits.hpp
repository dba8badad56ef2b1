// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/plan.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake::schedule {

/// What the cases of a plan need: the largest memory of a rank, and the disk space of all files.
struct Demand {
    double memory_per_rank_B = 0.0;
    double disk_B = 0.0;
};

/// The demand of the cases if all ranks share each case. Time steps are not probed. Of a large
/// plan, only the cases that can be estimated within a second are counted. Not collective.
Demand least_demand(const std::vector<PlannedCase>& cases, int ranks);

/// The error if the demand exceeds the memory per rank or the free space of the disk with `out` (or
/// its nearest existing parent); empty otherwise. Not collective.
std::string excess(const Demand& demand, double memory_per_rank_B,
                   const std::filesystem::path& out);

} // namespace shearwake::schedule
