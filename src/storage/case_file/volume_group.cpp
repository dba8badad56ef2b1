// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/volume_group.hpp"

#include "base/error.hpp"
#include "storage/case_file/variable_group.hpp"

#include <fmt/format.h>
#include <hdf5.h>

namespace shearwake::storage {
namespace {

std::string words_of(VolumeField field, const std::string& component) {
    switch (field) {
    case VolumeField::u:
        return fmt::format("displacement along {}{}", component,
                           component == "z" ? ", positive into the tissue" : "");
    case VolumeField::strain:
        return "component " + component + " of the strain tensor";
    case VolumeField::stress:
        return fmt::format("component {} of the stress tensor, tension positive", component);
    }
    return {};
}

} // namespace

std::vector<Variable> VolumeLayout::variables() const {
    std::vector<Variable> variables;
    for (const VolumeField field : fields)
        for (const std::string& component : components_of(field))
            variables.push_back({.name = name_of(field) + "_" + component,
                                 .dimensions = {"time", "z", "y", "x"},
                                 .units = units_of(field),
                                 .long_name = words_of(field, component)});
    return variables;
}

std::vector<hsize_t> VolumeLayout::shape() const {
    return {times_s.size(), z_m.size(), static_cast<hsize_t>(domain.ny),
            static_cast<hsize_t>(domain.nx)};
}

double VolumeLayout::bytes() const {
    double bytes = sizeof(double) * static_cast<double>(variables().size());
    for (const hsize_t extent : shape())
        bytes *= static_cast<double>(extent);
    return bytes;
}

std::size_t VolumeLayout::variable(std::size_t field, std::size_t component) const {
    std::size_t before = 0;
    for (std::size_t i = 0; i < field; ++i)
        before += components_of(fields[i]).size();
    return before + component;
}

void create_volume_group(hid_t file, const VolumeLayout& layout) {
    const h5::Id group = h5::create_group(file, "volume");
    const Domain& d = layout.domain;
    write_group(group.raw(),
                {{"time", {"time"}, layout.times_s, "s", "time since the load began", ""},
                 {"z", {"z"}, layout.z_m, "m", "depth below the skin surface", ""},
                 {"y",
                  {"y"},
                  coordinate(d.ny, [&](auto j) { return d.y_m(j); }),
                  "m",
                  "position along y",
                  ""},
                 {"x",
                  {"x"},
                  coordinate(d.nx, [&](auto i) { return d.x_m(i); }),
                  "m",
                  "position along x, the scan direction",
                  ""}});
    for (const Variable& variable : layout.variables())
        create_field(group.raw(), variable, layout.shape());
}

bool has_volume_group(hid_t file, const VolumeLayout& layout) {
    if (H5Lexists(file, "volume", H5P_DEFAULT) <= 0) return false;
    try {
        const h5::Id group = h5::open_group(file, "volume");
        for (const Variable& variable : layout.variables())
            if (h5::shape(h5::open_dataset(group.raw(), variable.name)) != layout.shape())
                return false;
        return true;
    } catch (const Error&) {
        return false;
    }
}

} // namespace shearwake::storage
