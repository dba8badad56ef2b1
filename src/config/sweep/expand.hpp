// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/files/loaders.hpp"
#include "config/sweep/sweep_axes.hpp"
#include "problem/case/plan.hpp"

namespace shearwake::config {

/// Returns all cases of the sweep, with the first axis slowest, followed by the references. `base`
/// is the complete job as a tree; `reference` contains the keys of load.modulation that define a
/// reference, or is null. Also checks the physics of all cases. After an error in [sweep], only the
/// first case is read.
std::vector<PlannedCase> expand(const NodePtr& base, const Sweep& sweep, const NodePtr& reference,
                                const FileLoaders& files, DiagnosticList& diagnostics);

/// Adds the axis of `[sweep] list = "cases.csv"` to the sweep: the first line of the file names
/// full keys, and every further line gives their values in one case. Without this entry nothing
/// changes.
void add_listed_cases(const NodePtr& sweep_node, Sweep& sweep, const FileLoaders& files,
                      DiagnosticList& diagnostics);

} // namespace shearwake::config
