#include "engines/spectral/cell_materials.hpp"

#include <algorithm>

namespace shearwake {

DepthCell depth_cell(const DepthMesh& mesh, std::size_t element, std::size_t node) {
    const double half = 0.5 * mesh.length_m(element);
    double top = mesh.ends_m[element];
    for (std::size_t i = 0; i < node; ++i)
        top += half * mesh.rule.weights[i];
    return {top + 0.5 * half * mesh.rule.weights[node], half * mesh.rule.weights[node]};
}

bool is_smooth(const Medium& medium) {
    return std::all_of(medium.bodies.begin(), medium.bodies.end(),
                       [](const Body& body) { return body.edge_m > 0.0; });
}

std::vector<Material> cell_materials(const Case& c, const DepthMesh& mesh, const SlabShare& share,
                                     const StrainPoint& point) {
    const auto node = static_cast<std::size_t>(point.node);
    const bool smooth = is_smooth(c.medium);
    const DepthCell cell = depth_cell(mesh, point.element, node);
    const double z_m = smooth
                           ? mesh.z_m(point.element * static_cast<std::size_t>(mesh.degree) + node)
                           : cell.centre_m;
    const Vec3 size_m = smooth ? Vec3{} : Vec3{c.domain.spacing_m, c.domain.spacing_m, cell.size_m};
    std::vector<Material> all;
    all.reserve(static_cast<std::size_t>(share.x_count * c.domain.ny));
    for (std::ptrdiff_t i = 0; i < share.x_count; ++i)
        for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j)
            all.push_back(material_of_cell(c.medium, mesh.layers[point.element],
                                           {c.domain.x_m(share.x_start + i), c.domain.y_m(j), z_m},
                                           size_m));
    return all;
}

} // namespace shearwake
