// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

/// The numbers that a key accepts, in its unit: the declared range within the physically plausible
/// range of its quantity. Values outside the latter would lead to overflow and to grids and tables
/// of arbitrary size. The reader, the schema and the reference of keys all use it.
struct KeyRange {
    Range range;               // both bounds
    double least_size = 0.0;   // smallest magnitude other than 0, if 0 is in the range
    std::string_view why = {}; // of the physical bounds; empty if the quantity has none

    bool contains(double value) const;
    std::string words() const; // "0 or between 1e-09 and 10000"
};

/// The quantity is that of the unit suffix of the key; wave speeds are recognised by their names.
KeyRange key_range(std::string_view key, const Range& declared);

/// The allowed words of a field whose type is "word:a|b" or "point or word:a|b"; none for other
/// types. The first one is the default of an optional key.
std::vector<std::string> words_of(const Field& field);

} // namespace shearwake::config
