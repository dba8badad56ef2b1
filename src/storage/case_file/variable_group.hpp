// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/record.hpp"
#include "storage/hdf5/h5.hpp"

#include <string>
#include <vector>

namespace shearwake::storage {

/// Writes variables to a group: coordinates as dimension scales, and the variables that depend on
/// them, each with a unit and a long name. Not collective.
void write_group(hid_t group, const std::vector<Variable>& variables);

/// Creates an empty field over coordinates of the group; `shape` contains their lengths.
void create_field(hid_t group, const Variable& words, const std::vector<hsize_t>& shape);

/// The values at(0) ... at(count - 1).
std::vector<double> coordinate(std::ptrdiff_t count, const auto& at) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (std::ptrdiff_t i = 0; i < count; ++i)
        values[static_cast<std::size_t>(i)] = at(i);
    return values;
}

} // namespace shearwake::storage
