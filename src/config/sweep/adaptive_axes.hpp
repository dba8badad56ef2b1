// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/tree.hpp"
#include "problem/case/adaptive_axis.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::config {

/// The points of adaptive axes by their keys, ascending, in the unit of the key.
using AxisPoints = std::map<std::string, std::vector<double>>;

/// Whether a value of [sweep] is { refine = [...], ... } or { find = "...", ... }.
bool is_adaptive(const Node& node);

/// Reads an adaptive axis; nothing after an error.
std::optional<AdaptiveAxis> read_adaptive_axis(const std::string& key, const NodePtr& node,
                                               DiagnosticList& diagnostics);

} // namespace shearwake::config
