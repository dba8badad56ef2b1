// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace shearwake {

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
