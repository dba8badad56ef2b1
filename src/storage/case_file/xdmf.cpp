// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/xdmf.hpp"

#include "storage/files.hpp"

#include <fmt/format.h>

namespace shearwake::storage {

void write_xdmf(const std::filesystem::path& case_file, const SurfaceLayout& layout) {
    const Domain& d = layout.domain;
    std::string text = "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n <Domain>\n"
                       "  <Grid Name=\"surface\" GridType=\"Collection\" "
                       "CollectionType=\"Temporal\">\n";
    for (std::size_t t = 0; t < layout.times_s.size(); ++t) {
        text += fmt::format("   <Grid Name=\"u_z\">\n    <Time Value=\"{}\"/>\n"
                            "    <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{} {} 1\"/>\n"
                            "    <Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n"
                            "     <DataItem Dimensions=\"3\" Format=\"XML\">{} {} 0</DataItem>\n"
                            "     <DataItem Dimensions=\"3\" Format=\"XML\">{} {} 1</DataItem>\n"
                            "    </Geometry>\n",
                            layout.times_s[t], d.nx, d.ny, d.x_m(0), d.y_m(0), d.spacing_m,
                            d.spacing_m);
        for (std::size_t depth = 0; depth < layout.depths_m.size(); ++depth) {
            text += fmt::format(
                "    <Attribute Name=\"u_z at {} mm\" Center=\"Node\">\n"
                "     <DataItem ItemType=\"HyperSlab\" Dimensions=\"{} {} 1\">\n"
                "      <DataItem Dimensions=\"3 4\" Format=\"XML\">{} {} 0 0 1 1 1 1 1 1 {} {}"
                "</DataItem>\n"
                "      <DataItem Dimensions=\"{} {} {} {}\" NumberType=\"Float\" Precision=\"8\" "
                "Format=\"HDF\">{}:/surface/u_z</DataItem>\n"
                "     </DataItem>\n    </Attribute>\n",
                1e3 * layout.depths_m[depth], d.nx, d.ny, t, depth, d.nx, d.ny,
                layout.times_s.size(), layout.depths_m.size(), d.nx, d.ny,
                case_file.filename().string());
        }
        text += "   </Grid>\n";
    }
    text += "  </Grid>\n </Domain>\n</Xdmf>\n";
    std::filesystem::path path = case_file;
    write_file(path.replace_extension(".xdmf"), text);
}

void write_volume_xdmf(const std::filesystem::path& case_file, const VolumeLayout& layout) {
    const std::string file = case_file.filename().string();
    const std::size_t times = layout.times_s.size(), nz = layout.z_m.size();
    const std::string shape = fmt::format("{} {} {}", nz, layout.domain.ny, layout.domain.nx);
    const auto axis = [&](const char* name, auto extent) {
        return fmt::format("     <DataItem Dimensions=\"{}\" NumberType=\"Float\" Precision=\"8\" "
                           "Format=\"HDF\">{}:/volume/{}</DataItem>\n",
                           extent, file, name);
    };
    std::string text = "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n <Domain>\n"
                       "  <Grid Name=\"volume\" GridType=\"Collection\" "
                       "CollectionType=\"Temporal\">\n";
    for (std::size_t t = 0; t < times; ++t) {
        text += fmt::format("   <Grid Name=\"volume\">\n    <Time Value=\"{}\"/>\n"
                            "    <Topology TopologyType=\"3DRectMesh\" Dimensions=\"{}\"/>\n"
                            "    <Geometry GeometryType=\"VXVYVZ\">\n{}{}{}    </Geometry>\n",
                            layout.times_s[t], shape, axis("x", layout.domain.nx),
                            axis("y", layout.domain.ny), axis("z", nz));
        for (const Variable& variable : layout.variables())
            text += fmt::format(
                "    <Attribute Name=\"{}\" Center=\"Node\">\n"
                "     <DataItem ItemType=\"HyperSlab\" Dimensions=\"{}\">\n"
                "      <DataItem Dimensions=\"3 4\" Format=\"XML\">{} 0 0 0 1 1 1 1 1 {}"
                "</DataItem>\n"
                "      <DataItem Dimensions=\"{} {}\" NumberType=\"Float\" Precision=\"8\" "
                "Format=\"HDF\">{}:/volume/{}</DataItem>\n"
                "     </DataItem>\n    </Attribute>\n",
                variable.name, shape, t, shape, times, shape, file, variable.name);
        text += "   </Grid>\n";
    }
    text += "  </Grid>\n </Domain>\n</Xdmf>\n";
    std::filesystem::path path = case_file;
    write_file(path.replace_extension(".volume.xdmf"), text);
}

} // namespace shearwake::storage
