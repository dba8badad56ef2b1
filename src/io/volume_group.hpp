#pragma once

#include "io/h5.hpp"
#include "model/case.hpp"
#include "model/record.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// The volume snapshots that a case keeps: each component of each field as a variable of its own,
/// u_x(time, z, y, x), in group /volume. x varies fastest, as ParaView's rectilinear grids want it.
struct VolumeLayout {
    Domain domain;
    std::vector<double> times_s;
    std::vector<VolumeField> fields;
    std::vector<double> z_m; // depths of the levels

    bool empty() const { return times_s.empty(); }
    double bytes() const;
    /// Without values; in the order of fields and components.
    std::vector<Variable> variables() const;
    /// Of each variable.
    std::vector<hsize_t> shape() const;
    /// Place of a field's component among the variables.
    std::size_t variable(std::size_t field, std::size_t component) const;
};

/// Makes /volume with its scales and room for its variables. Not collective.
void create_volume_group(hid_t file, const VolumeLayout& layout);

/// Whether the file has /volume as it would be created. Not collective.
bool has_volume_group(hid_t file, const VolumeLayout& layout);

} // namespace shearwake
