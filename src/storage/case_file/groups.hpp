// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/plan.hpp"
#include "problem/case/volume.hpp"
#include "storage/hdf5/h5.hpp"

#include <string>
#include <vector>

namespace shearwake::storage {

/// Writes variables to a group: coordinates as dimension scales, and the variables that depend on
/// them, each with a unit and a long name. Not collective.
void write_group(hid_t group, const std::vector<Variable>& variables);

/// Writes the groups, of which one without a name is the root, and the attributes of a file that
/// ends in its checksum. Not collective.
void write_groups(hid_t file, const std::vector<VariableGroup>& groups,
                  const std::vector<Attribute>& attributes);

/// Creates an empty field over coordinates of the group; `shape` contains their lengths.
void create_field(hid_t group, const Variable& words, const std::vector<hsize_t>& shape);

/// The values at(0) ... at(count - 1).
std::vector<double> coordinate(std::ptrdiff_t count, const auto& at) {
    std::vector<double> values(static_cast<std::size_t>(count));
    for (std::ptrdiff_t i = 0; i < count; ++i)
        values[static_cast<std::size_t>(i)] = at(i);
    return values;
}

/// The coordinates x and y of a domain. Not collective.
Variable x_coordinate(const Domain& domain);
Variable y_coordinate(const Domain& domain);

/// The attribute `warnings` of a case file: a JSON array of {severity, key, message}. The severity
/// "error" marks a case whose readings are not valid.
std::string warnings_text(const std::vector<Remark>& warnings);
/// One of them.
std::string warning_text(const Remark& warning);

/// The warnings in such a text; none if it is not valid.
std::vector<Remark> warnings_in(const std::string& text);

/// The volume snapshots that a case stores: each component of each field is a variable u_x(time, z,
/// y, x) in group /volume. x varies fastest, as rectilinear grids of ParaView require.
struct VolumeLayout {
    Domain domain;
    std::vector<double> times_s;
    std::vector<VolumeField> fields;
    std::vector<double> z_m; // depths of the levels

    bool empty() const { return times_s.empty(); }
    double bytes() const;
    /// Without values; in the order of fields and components.
    std::vector<Variable> variables() const;
    /// The shape of each variable.
    std::vector<hsize_t> shape() const;
    /// Index of a component of a field among the variables.
    std::size_t variable(std::size_t field, std::size_t component) const;
};

/// Creates /volume with its scales and space for its variables. Not collective.
void create_volume_group(hid_t file, const VolumeLayout& layout);

/// Whether the file has /volume with this layout. Not collective.
bool has_volume_group(hid_t file, const VolumeLayout& layout);

} // namespace shearwake::storage
