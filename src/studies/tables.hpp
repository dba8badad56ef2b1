// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "reduce/reduce.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/run.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake::studies {

/// Overrides that reduce a job to one case without its sweep, followed by `overrides`. `table`: the
/// table [table] of that case.
std::vector<std::string> one_case_overrides(const std::vector<std::string>& overrides,
                                            const std::string& table = "{}");

struct Evaluation {
    ExitCode code; // done or some_cases_failed: the folder contains a plan with the case
    schedule::OutputFolder folder;
};

/// Computes one case of a job without its sweep, unless it is already known, in a folder of its own
/// in `out` (empty: out/<job name>.evaluate). Collective over the world.
Evaluation evaluate(const schedule::JobArguments& arguments, const std::filesystem::path& out,
                    const Comm& world);

/// The table of an output folder that has a plan, see reduce::table_of(). Not collective.
reduce::Table table_of(const schedule::OutputFolder& folder);

/// Writes the tables of an output folder. Without plan.json the plan is reconstructed from the case
/// files; see reduce::reduce(). Throws UsageError (environment) if this is not an output folder.
/// Not collective.
reduce::ReducedTables reduce_folder(const schedule::OutputFolder& folder,
                                    reduce::ErrorColumns errors);

} // namespace shearwake::studies
