// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::schedule {

/// What the cases of a plan need: the largest memory of a rank, and the disk space of all files.
struct Demand {
    double memory_per_rank_B = 0.0;
    double disk_B = 0.0;
};

/// The demand of the cases if all ranks share each case. Time steps are not probed. Of a large
/// plan, only the cases that can be estimated within a second are counted. Not collective.
Demand least_demand(const std::vector<const PlannedCase*>& cases, int ranks);

/// What a user can do if another machine runs the job, or who accepts the risk; the end of the
/// message of excess().
inline constexpr std::string_view run_elsewhere = "add --elsewhere if another machine runs the job";
inline constexpr std::string_view run_by_force =
    "add --force to run the job nevertheless (cases that exceed the memory fail)";

/// The error if the demand exceeds the memory per rank or the free space of the disk with `out` (or
/// its nearest existing parent), without "error: "; empty otherwise. Not collective.
std::string excess(const Demand& demand, double memory_per_rank_B, const std::filesystem::path& out,
                   std::string_view remedy);

} // namespace shearwake::schedule
