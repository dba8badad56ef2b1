// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/case_file_writer.hpp"

#include "storage/files.hpp"

#include <fmt/format.h>
#include <iterator>
#include <string_view>
#include <vector>

namespace shearwake::storage {

namespace {

constexpr std::string_view heading =
    "<?xml version=\"1.0\"?>\n"
    "<Xdmf xmlns:xi=\"http://www.w3.org/2001/XInclude\" Version=\"3.0\">\n <Domain>\n";

/// The start of a collection over time. Readers show its name.
std::string over_time(std::string_view name) {
    return fmt::format("  <Grid Name=\"{} (x, y, z in m, time in s)\" GridType=\"Collection\" "
                       "CollectionType=\"Temporal\">\n",
                       name);
}

constexpr std::string_view ending = "  </Grid>\n </Domain>\n</Xdmf>\n";

std::string time_s(double time_s) {
    return fmt::format("    <Time Value=\"{}\"/>\n    <Information Name=\"unit of time\" "
                       "Value=\"s\"/>\n",
                       time_s);
}

/// "u_z (m)"; the unit of strains, 1, is omitted.
std::string name_with_unit(const std::string& name, const std::string& unit) {
    return unit == "1" ? name : fmt::format("{} ({})", name, unit);
}

/// The nodes of the surface grid at a depth in the order of the stored values, y fastest. Readers
/// assume that x varies fastest, unless each node has coordinates.
std::string surface_nodes(const Domain& d, double z_m) {
    std::string text =
        fmt::format("     <Geometry GeometryType=\"XYZ\">\n      <DataItem Dimensions=\"{} 3\" "
                    "NumberType=\"Float\" Precision=\"8\" Format=\"XML\">\n",
                    d.nx * d.ny);
    for (std::ptrdiff_t i = 0; i < d.nx; ++i)
        for (std::ptrdiff_t j = 0; j < d.ny; ++j)
            fmt::format_to(std::back_inserter(text), "{:.12g} {:.12g} {:.12g}\n", d.x_m(i),
                           d.y_m(j), z_m);
    return text + "      </DataItem>\n     </Geometry>\n";
}

/// One time and depth of /surface/u_z of a case file.
std::string surface_values(const std::string& file, const SurfaceLayout& layout, std::size_t time,
                           std::size_t depth) {
    const Domain& d = layout.domain;
    return fmt::format(
        "     <Attribute Name=\"{}\" Center=\"Node\">\n"
        "      <DataItem ItemType=\"HyperSlab\" Dimensions=\"1 {} {}\">\n"
        "       <DataItem Dimensions=\"3 4\" Format=\"XML\">{} {} 0 0 1 1 1 1 1 1 {} {}"
        "</DataItem>\n"
        "       <DataItem Dimensions=\"{} {} {} {}\" NumberType=\"Float\" Precision=\"8\" "
        "Format=\"HDF\">{}:/surface/u_z</DataItem>\n"
        "      </DataItem>\n     </Attribute>\n",
        name_with_unit("u_z", "m"), d.nx, d.ny, time, depth, d.nx, d.ny, layout.times_s.size(),
        layout.depths_m.size(), d.nx, d.ny, file);
}

/// One time of a variable of /volume of a case file.
std::string volume_values(const std::string& file, const VolumeLayout& layout,
                          const std::string& name, std::size_t time) {
    const std::string shape =
        fmt::format("{} {} {}", layout.z_m.size(), layout.domain.ny, layout.domain.nx);
    return fmt::format("     <DataItem ItemType=\"HyperSlab\" Dimensions=\"{}\">\n"
                       "      <DataItem Dimensions=\"3 4\" Format=\"XML\">{} 0 0 0 1 1 1 1 1 {}"
                       "</DataItem>\n"
                       "      <DataItem Dimensions=\"{} {}\" NumberType=\"Float\" "
                       "Precision=\"8\" Format=\"HDF\">{}:/volume/{}</DataItem>\n"
                       "     </DataItem>\n",
                       shape, time, shape, layout.times_s.size(), shape, file, name);
}

} // namespace

void write_xdmf(const std::filesystem::path& case_file, const SurfaceLayout& layout) {
    const std::string file = case_file.filename().string();
    std::string text(heading);
    text += over_time("surface");
    for (std::size_t t = 0; t < layout.times_s.size(); ++t) {
        text += "   <Grid Name=\"surface\" GridType=\"Collection\" CollectionType=\"Spatial\">\n";
        text += time_s(layout.times_s[t]);
        for (std::size_t depth = 0; depth < layout.depths_m.size(); ++depth) {
            const double z_m = layout.depths_m[depth];
            text +=
                fmt::format("    <Grid Name=\"z = {:g} mm\">\n"
                            "     <Topology TopologyType=\"3DSMesh\" Dimensions=\"1 {} {}\"/>\n",
                            1e3 * z_m, layout.domain.nx, layout.domain.ny);
            // The nodes are those of the first time. They follow the time, its unit, the grids of
            // lesser depths and the topology.
            text += t == 0 ? surface_nodes(layout.domain, z_m)
                           : fmt::format("     <xi:include xpointer=\"element(/1/1/1/1/{}/2)\"/>\n",
                                         depth + 3);
            text += surface_values(file, layout, t, depth) + "    </Grid>\n";
        }
        text += "   </Grid>\n";
    }
    std::filesystem::path path = case_file;
    write_file(path.replace_extension(".xdmf"), text.append(ending));
}

void write_volume_xdmf(const std::filesystem::path& case_file, const VolumeLayout& layout) {
    const std::string file = case_file.filename().string();
    const std::size_t nz = layout.z_m.size();
    const std::string shape = fmt::format("{} {} {}", nz, layout.domain.ny, layout.domain.nx);
    const auto axis = [&](const char* name, auto extent) {
        return fmt::format("     <DataItem Dimensions=\"{}\" NumberType=\"Float\" Precision=\"8\" "
                           "Format=\"HDF\">{}:/volume/{}</DataItem>\n",
                           extent, file, name);
    };
    const std::vector<Variable> variables = layout.variables();
    std::string text(heading);
    text += over_time("volume");
    for (std::size_t t = 0; t < layout.times_s.size(); ++t) {
        text += "   <Grid Name=\"volume\">\n" + time_s(layout.times_s[t]);
        text += fmt::format("    <Topology TopologyType=\"3DRectMesh\" Dimensions=\"{}\"/>\n"
                            "    <Geometry GeometryType=\"VXVYVZ\">\n{}{}{}    </Geometry>\n",
                            shape, axis("x", layout.domain.nx), axis("y", layout.domain.ny),
                            axis("z", nz));
        std::string displacement;
        for (const Variable& variable : variables) {
            const std::string values = volume_values(file, layout, variable.name, t);
            text += fmt::format("    <Attribute Name=\"{}\" Center=\"Node\">\n{}"
                                "    </Attribute>\n",
                                name_with_unit(variable.name, variable.units), values);
            if (variable.name.starts_with("u_")) displacement += values;
        }
        if (!displacement.empty())
            text +=
                fmt::format("    <Attribute Name=\"{}\" AttributeType=\"Vector\" Center=\"Node\">\n"
                            "     <DataItem ItemType=\"Function\" Function=\"JOIN($0, $1, $2)\" "
                            "Dimensions=\"{} 3\">\n{}     </DataItem>\n    </Attribute>\n",
                            name_with_unit("u", "m"), shape, displacement);
        text += "   </Grid>\n";
    }
    std::filesystem::path path = case_file;
    write_file(path.replace_extension(".volume.xdmf"), text.append(ending));
}

} // namespace shearwake::storage
