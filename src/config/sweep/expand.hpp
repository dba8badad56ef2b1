// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/files/text_loader.hpp"
#include "config/sweep/sweep_axes.hpp"
#include "problem/case/plan.hpp"

namespace shearwake::config {

/// Returns all cases of the sweep, with the first axis slowest, followed by the references. `base`
/// is the complete job as a tree; `reference` contains the keys of load.modulation that define a
/// reference, or is null. Also checks the physics of all cases. After an error in [sweep], only the
/// first case is read.
std::vector<PlannedCase> expand(const NodePtr& base, const Sweep& sweep, const NodePtr& reference,
                                const FileLoaders& files, DiagnosticList& diagnostics);

} // namespace shearwake::config
