// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/files/text_loader.hpp"
#include "config/sweep/sweep_axes.hpp"

namespace shearwake::config {

/// Adds the axis of `[sweep] list = "cases.csv"` to the sweep: the first line of the file names
/// full keys, and every further line gives their values in one case. Without this entry nothing
/// changes.
void add_listed_cases(const NodePtr& sweep_node, Sweep& sweep, const FileLoaders& files,
                      DiagnosticList& diagnostics);

} // namespace shearwake::config
