#pragma once

#include "config/tree.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// More cases than this, or more values on one axis, are taken for a slip.
constexpr std::size_t most_cases = 100000;

/// { linspace = [...] }, { logspace = [...] } or { range = [...] }.
bool is_generator(const Node& node);

/// The values of an axis: a list, or a generator. Findings, and nothing, where it is neither, is
/// empty, or holds a value twice. `key` is for messages.
std::vector<NodePtr> axis_values(const std::string& key, const NodePtr& node,
                                 Diagnostics& findings);

} // namespace shearwake
