#pragma once

#include "io/h5.hpp"
#include "model/record.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// Writes variables into a group: coordinates as dimension scales, and what lies over them; units
/// and long names on each. Not collective.
void write_group(hid_t group, const std::vector<Variable>& variables);

/// An empty field over coordinates that the group has; `shape` are their lengths.
void create_field(hid_t group, const Variable& words, const std::vector<hsize_t>& shape);

/// The values at(0) ... at(count - 1).
std::vector<double> coordinate(std::ptrdiff_t count, const auto& at) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (std::ptrdiff_t i = 0; i < count; ++i)
        values[static_cast<std::size_t>(i)] = at(i);
    return values;
}

} // namespace shearwake
