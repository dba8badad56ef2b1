// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/tree.hpp"
#include "problem/case/plan.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::config {

/// Limit of the number of cases and of the values on an axis; more are considered a typing error.
constexpr std::size_t most_cases = 10000;

/// { linspace = [...] }, { logspace = [...] } or { range = [...] }.
bool is_generator(const Node& node);

/// The values of an axis: a list or a generator. If it is neither, is empty, or contains a value
/// twice, reports errors and returns no values. `key` is for messages.
std::vector<NodePtr> axis_values(const std::string& key, const NodePtr& node,
                                 DiagnosticList& diagnostics);

/// The points of adaptive axes by their keys, ascending, in the unit of the key.
using AxisPoints = std::map<std::string, std::vector<double>>;

/// Whether a value of [sweep] is { refine = [...], ... } or { find = "...", ... }.
bool is_adaptive(const Node& node);

/// Reads an adaptive axis; nothing after an error.
std::optional<AdaptiveAxis> read_adaptive_axis(const std::string& key, const NodePtr& node,
                                               DiagnosticList& diagnostics);

} // namespace shearwake::config
