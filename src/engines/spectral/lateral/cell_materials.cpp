// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/cell_materials.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake::spectral {

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

double shear_reflection(double stiffness_ratio, double density_ratio) {
    const double z = std::sqrt(stiffness_ratio * density_ratio);
    return (z - 1.0) / (z + 1.0);
}

CappedMaterials::CappedMaterials(const Case& c, const Material& layer)
    : most_mu_Pa_(std::get<SpectralOptions>(c.solver).contrast_cap * layer.mu_Pa) {}

CellMaterial CappedMaterials::operator()(CellMaterial m) const {
    if (m.mu_Pa > most_mu_Pa_) {
        // With a negative lambda, so that the bulk modulus remains positive.
        if (m.lambda_Pa < 0.0) m.lambda_Pa *= most_mu_Pa_ / m.mu_Pa;
        m.mu_Pa = most_mu_Pa_;
    }
    m.mu_across_Pa = std::min(m.mu_across_Pa, most_mu_Pa_);
    return m;
}

std::array<double, 6> stress_across(Vec3 n, const std::array<double, 6>& e) {
    const Vec3 w{e[xx] * n.x + 0.5 * (e[xy] * n.y + e[xz] * n.z),
                 e[yy] * n.y + 0.5 * (e[xy] * n.x + e[yz] * n.z),
                 e[zz] * n.z + 0.5 * (e[xz] * n.x + e[yz] * n.y)};
    const Vec3 t = w - (w.x * n.x + w.y * n.y + w.z * n.z) * n;
    return {-4.0 * n.x * t.x,
            -4.0 * n.y * t.y,
            -4.0 * n.z * t.z,
            -2.0 * (n.y * t.z + n.z * t.y),
            -2.0 * (n.x * t.z + n.z * t.x),
            -2.0 * (n.x * t.y + n.y * t.x)};
}

namespace {

std::vector<CellMaterial> plane_of_materials(const Case& c, std::size_t layer,
                                             const fft::SlabShare& share, double z_m,
                                             const DepthCell& cell) {
    const Medium& medium = c.scene.medium;
    const bool smooth = is_smooth(medium), map_alone = medium.map && medium.bodies.empty();
    const Vec3 size_m{c.domain.spacing_m, c.domain.spacing_m, cell.size_m};
    std::vector<CellMaterial> all;
    all.reserve(static_cast<std::size_t>(share.x_count * c.domain.ny));
    for (std::ptrdiff_t i = 0; i < share.x_count; ++i)
        for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j) {
            Vec3 at_m{c.domain.x_m(share.x_start + i), c.domain.y_m(j), cell.centre_m};
            CellMaterial m;
            if (!smooth || map_alone) m = material_of_cell(medium, layer, at_m, size_m);
            if (smooth && !m.is_laminate()) {
                at_m.z = z_m;
                m = material_of_cell(medium, layer, at_m, {});
            }
            all.push_back(m);
        }
    return all;
}

} // namespace

std::vector<CellMaterial> cell_materials(const Case& c, const DepthMesh& mesh,
                                         const fft::SlabShare& share, const StrainPoint& point) {
    const auto node = static_cast<std::size_t>(point.node);
    return plane_of_materials(
        c, mesh.layers[point.element], share,
        mesh.z_m(point.element * static_cast<std::size_t>(mesh.degree) + node),
        depth_cell(mesh, point.element, node));
}

std::vector<CellMaterial> cell_materials(const Case& c, const DepthMesh& mesh,
                                         const fft::SlabShare& share, std::size_t element,
                                         double depth_m) {
    std::size_t node = 0;
    const auto bottom_m = [&](const DepthCell& cell) { return cell.centre_m + 0.5 * cell.size_m; };
    while (node + 1 < mesh.rule.nodes.size() && bottom_m(depth_cell(mesh, element, node)) < depth_m)
        ++node;
    return plane_of_materials(c, mesh.layers[element], share, depth_m,
                              depth_cell(mesh, element, node));
}

namespace {

/// Range of the points at which cells of one spacing intersect an interval, which is given in
/// spacings from the first point.
std::pair<std::ptrdiff_t, std::ptrdiff_t> cells_of(double low, double high, std::ptrdiff_t points) {
    constexpr double rounding = 1e-9;
    const auto within = [points](double at) {
        return static_cast<std::ptrdiff_t>(std::clamp(at, 0.0, static_cast<double>(points)));
    };
    return {within(std::floor(low - 0.5 + rounding) + 1.0),
            within(std::ceil(high + 0.5 - rounding))};
}

} // namespace

CellExtent extent_of(const Medium& medium, const Domain& domain) {
    std::vector<Bounds> boxes;
    for (const Body& body : medium.bodies)
        boxes.push_back(bounds(body));
    if (const MaterialMap* map = medium.map.get()) {
        const auto first = map->origin_m, step = map->spacing_m;
        const auto last = [&](std::size_t axis, double from, double by) {
            return from + static_cast<double>(map->counts[axis] - 1) * by;
        };
        // A single point without a spacing has no bounds.
        const auto half = [](double by) {
            return by == 0.0 ? std::numeric_limits<double>::infinity() : 0.5 * by;
        };
        boxes.push_back({{first.x - half(step.x), first.y - half(step.y), 0.0},
                         {last(0, first.x, step.x) + half(step.x),
                          last(1, first.y, step.y) + half(step.y), 0.0}});
    }
    CellExtent all;
    const double h = domain.spacing_m, x_m = domain.x_m(0), y_m = domain.y_m(0);
    for (const Bounds& box : boxes) {
        const auto x = cells_of((box.low_m.x - x_m) / h, (box.high_m.x - x_m) / h, domain.nx),
                   y = cells_of((box.low_m.y - y_m) / h, (box.high_m.y - y_m) / h, domain.ny);
        if (x.first >= x.second || y.first >= y.second) continue; // beyond the edges
        all = all.with({x.first, x.second, y.first, y.second});
    }
    return all;
}

CellExtent PlaneCells::extent(const Comm* team) const {
    constexpr double none = std::numeric_limits<double>::lowest();
    double most[4] = {none, none, none, none}; // -x, x, -y, y
    const auto widen = [](double& at, std::ptrdiff_t value) {
        at = std::max(at, static_cast<double>(value));
    };
    for (const Point& point : points)
        for (const fft::RowRun& run : point.runs) {
            const std::ptrdiff_t x = x_start + run.row;
            widen(most[0], -x);
            widen(most[1], x + 1);
            widen(most[2], -run.begin);
            widen(most[3], run.end);
        }
    if (team) team->max(std::span<double>(most));
    if (most[0] == none) return {};
    const auto index = [](double value) { return static_cast<std::ptrdiff_t>(value); };
    return {index(-most[0]), index(most[1]), index(-most[2]), index(most[3])};
}

} // namespace shearwake::spectral
