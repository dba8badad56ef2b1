// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// A field that a case may store over the whole volume: displacement [m], strain (components of the
/// tensor), stress [Pa].
enum class VolumeField { u, strain, stress };
constexpr auto names_of(std::type_identity<VolumeField>) {
    return std::array{"u", "strain", "stress"};
}

/// Its name in job files and case files.
std::string name_of(VolumeField field);
std::string units_of(VolumeField field);

/// x, y, z for the displacement; xx, yy, zz, yz, xz, xy for strain and stress. z points into the
/// tissue.
std::vector<std::string> components_of(VolumeField field);

/// A quantity over named dimensions, row-major, in SI units unless `units` differs. A variable with
/// the name of its only dimension is the coordinate of that dimension. NaN: no value; `note` gives
/// the reason.
struct Variable {
    std::string name;
    std::vector<std::string> dimensions; // none: a scalar
    std::vector<double> values;
    std::string units; // "1" for pure numbers
    std::string long_name;
    std::string note;
};

struct Attribute {
    std::string name;
    std::variant<std::string, double, long> value;
};

/// Variables that share their dimensions: one group of a case file.
struct VariableGroup {
    std::string name; // empty: the root
    std::vector<Variable> variables;
};

} // namespace shearwake
