// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/record.hpp"
#include "storage/hdf5/h5.hpp"

#include <string>
#include <vector>

namespace shearwake::storage {

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
