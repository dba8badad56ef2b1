// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reduce/reduce.hpp"
#include "schedule/run/output_folder.hpp"

namespace shearwake::studies {

/// The table of an output folder that has a plan, see reduce::table_of(). Not collective.
reduce::Table table_of(const schedule::OutputFolder& folder);

/// Writes the tables of an output folder. Without plan.json the plan is reconstructed from the case
/// files; see reduce::reduce(). Throws UsageError (environment) if this is not an output folder.
/// Not collective.
reduce::ReducedTables reduce_folder(const schedule::OutputFolder& folder,
                                    reduce::ErrorColumns errors);

} // namespace shearwake::studies
