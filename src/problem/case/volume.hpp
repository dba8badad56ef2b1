// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"

#include <algorithm>
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

/// Data that are stored in addition to the measures.
struct RecordOptions {
    std::vector<Vec2> traces_m;
    std::vector<double> snapshots_s;
    bool frames = false;
    std::vector<double> volumes_s;          // ascending times of frames
    std::vector<VolumeField> volume_fields; // without duplicates; empty without volumes
    bool operator==(const RecordOptions&) const = default;
};

/// Whether volumes of strain or stress are requested.
inline bool records_tensors(const RecordOptions& record) {
    return std::ranges::any_of(record.volume_fields,
                               [](VolumeField field) { return field != VolumeField::u; });
}

struct Attribute {
    std::string name;
    std::variant<std::string, double, long> value;
};

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
    std::vector<Attribute> attributes = {}; // in addition to those of the other members
};

/// Variables that share their dimensions: one group of a case file.
struct VariableGroup {
    std::string name; // empty: the root
    std::vector<Variable> variables;

    void add(std::string variable, std::vector<std::string> dimensions, std::vector<double> values,
             std::string units, std::string long_name, std::string note = "") {
        variables.push_back({std::move(variable), std::move(dimensions), std::move(values),
                             std::move(units), std::move(long_name), std::move(note)});
    }
    void add_attribute(std::string attribute, std::string value) {
        variables.back().attributes.push_back({std::move(attribute), std::move(value)});
    }
};

} // namespace shearwake
