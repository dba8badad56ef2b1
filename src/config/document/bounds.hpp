// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

namespace shearwake::config {

/// The physically plausible range of a quantity in SI units, which applies in addition to the range
/// of a key. Values outside it would lead to overflow and to grids and tables of arbitrary size.
struct PhysicalBounds {
    double least; // smallest nonzero magnitude
    double most;
    std::string_view reason;
};

/// Determined by the unit suffix of the key, and for wave speeds by the key itself.
std::optional<PhysicalBounds> physical_bounds(std::string_view key);

/// How to request what a user may have meant by the value 0 of a key that must not be 0; empty if
/// nothing is known. `kind`: that of the same table, or empty. A sentence without a capital letter
/// and a full stop.
std::string_view instead_of_zero(std::string_view key, std::string_view kind);

} // namespace shearwake::config
