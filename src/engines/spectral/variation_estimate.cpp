// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_estimate.hpp"

#include "engines/spectral/lateral/cell_materials.hpp"
#include "engines/spectral/lateral/lateral_variation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::spectral {
namespace {

/// Maximum number of samples of the map.
constexpr std::ptrdiff_t map_samples = 500;

/// A box in which the medium may differ from the layers, and its materials.
struct Inclusion {
    Bounds box;
    double filled; // filled share of the box in a horizontal plane
    std::vector<std::vector<CellMaterial>> materials; // per layer
};

double volume_of(const Bounds& box) {
    const Vec3 size = box.high_m - box.low_m;
    return size.x * size.y * size.z;
}

double filled_share(const Body& body) {
    const double share =
        std::holds_alternative<Ellipsoid>(body.shape) ? std::numbers::pi / 4.0 : 1.0;
    // The volume of the body is the same, but that of its bounds is not.
    return is_turned(body) ? share * volume_of(bounds(aligned(body))) / volume_of(bounds(body))
                           : share;
}

Inclusion inclusion_of(const Medium& medium, const Body& body) {
    Inclusion part{bounds(body), filled_share(body), {}};
    for (std::size_t layer = 0; layer < medium.layers.size(); ++layer)
        part.materials.push_back({material_of_cell(medium, layer, body.centre_m, {})});
    return part;
}

Inclusion inclusion_of(const Medium& medium, const MaterialMap& map) {
    Inclusion part{{}, 1.0, std::vector<std::vector<CellMaterial>>(medium.layers.size())};
    const auto rim = [&](std::size_t axis, double first, double spacing, double& low,
                         double& high) {
        constexpr double endless = 1e9;
        const double last = first + spacing * static_cast<double>(map.counts[axis] - 1);
        low = spacing > 0.0 ? first - 0.5 * spacing : -endless;
        high = spacing > 0.0 ? last + 0.5 * spacing : endless;
    };
    rim(0, map.origin_m.x, map.spacing_m.x, part.box.low_m.x, part.box.high_m.x);
    rim(1, map.origin_m.y, map.spacing_m.y, part.box.low_m.y, part.box.high_m.y);
    rim(2, map.origin_m.z, map.spacing_m.z, part.box.low_m.z, part.box.high_m.z);
    const std::ptrdiff_t all = map.counts[0] * map.counts[1] * map.counts[2];
    const std::ptrdiff_t stride = std::max<std::ptrdiff_t>(1, all / map_samples) | 1;
    Medium bare{.layers = medium.layers, .base = medium.base, .bodies = {}, .map = medium.map};
    for (std::ptrdiff_t at = 0; at < all; at += stride) {
        const Vec3 place{
            map.origin_m.x +
                map.spacing_m.x * static_cast<double>(at / (map.counts[1] * map.counts[2])),
            map.origin_m.y +
                map.spacing_m.y * static_cast<double>(at / map.counts[2] % map.counts[1]),
            map.origin_m.z + map.spacing_m.z * static_cast<double>(at % map.counts[2])};
        for (std::size_t layer = 0; layer < medium.layers.size(); ++layer)
            part.materials[layer].push_back(material_of_cell(bare, layer, place, {}));
    }
    return part;
}

std::vector<Inclusion> inclusions_of(const Medium& medium) {
    std::vector<Inclusion> all;
    for (const Body& body : medium.bodies)
        all.push_back(inclusion_of(medium, body));
    if (medium.map) all.push_back(inclusion_of(medium, *medium.map));
    return all;
}

/// Minimum and maximum of each property at a strain point, and the number of cells in its plane.
struct PointEstimate {
    Material least, greatest;
    double cells = 0.0, fullest = 0.0;
    bool varies = false;
};

/// Number of cells of a box in the plane: in total and on the rank with most cells.
void add_cells(const Domain& d, const Inclusion& part, double rows_of_rank, PointEstimate& point) {
    const auto along = [&](double low, double high, std::ptrdiff_t n) {
        const double half = 0.5 * static_cast<double>(n) * d.spacing_m;
        const double length = std::min(high, half) - std::max(low, -half);
        return std::clamp(length / d.spacing_m + 1.0, 0.0, static_cast<double>(n));
    };
    const double x = along(part.box.low_m.x, part.box.high_m.x, d.nx);
    const double y = along(part.box.low_m.y, part.box.high_m.y, d.ny);
    point.cells += part.filled * x * y;
    point.fullest += (x <= rows_of_rank ? part.filled : 1.0) * std::min(x, rows_of_rank) * y;
}

PointEstimate estimate_point(const Case& c, const std::vector<Inclusion>& medium,
                             std::size_t layer_at, double top_m, double bottom_m,
                             double rows_of_rank) {
    const Material layer = material_of(c.scene().medium.layers[layer_at]);
    const CappedMaterials capped(c, layer);
    PointEstimate point{.least = layer, .greatest = layer};
    const auto widen = [](double value, double& least, double& greatest) {
        least = std::min(least, value);
        greatest = std::max(greatest, value);
    };
    for (const Inclusion& part : medium) {
        if (part.box.high_m.z <= top_m || part.box.low_m.z >= bottom_m) continue;
        for (const CellMaterial& material : part.materials[layer_at]) {
            const Material m = capped(material);
            Material &least = point.least, &greatest = point.greatest;
            widen(m.density_kg_m3, least.density_kg_m3, greatest.density_kg_m3);
            widen(m.lambda_Pa, least.lambda_Pa, greatest.lambda_Pa);
            widen(m.mu_Pa, least.mu_Pa, greatest.mu_Pa);
            widen(m.viscosity_Pa_s, least.viscosity_Pa_s, greatest.viscosity_Pa_s);
        }
        add_cells(c.domain, part, rows_of_rank, point);
    }
    point.varies = point.least != point.greatest;
    return point;
}

/// Inputs of the estimates of all strain points.
struct Setting {
    const Case& c;
    const DepthMesh& mesh;
    double step_s, rows, k_max_rad_m, k_load_rad_m, finest;
    std::vector<Inclusion> medium;
};

/// Deviation of the operator from its background, relative to the background, and properties that
/// require iterations at any contrast.
struct Contrast {
    double inertia = 0.0;
    bool of_lambda_or_viscosity = false, of_density = false;
};

std::vector<PointEstimate> points_of_element(const Setting& s, std::size_t element) {
    std::vector<PointEstimate> points;
    for (std::size_t i = 0; i < s.mesh.rule.nodes.size(); ++i) {
        const DepthCell cell = depth_cell(s.mesh, element, i);
        points.push_back(estimate_point(s.c, s.medium, s.mesh.layers[element],
                                        cell.centre_m - 0.5 * cell.size_m,
                                        cell.centre_m + 0.5 * cell.size_m, s.rows));
    }
    return points;
}

bool lambda_varies(const PointEstimate& p) {
    return implicit_lambda_Pa(p.greatest.lambda_Pa) >
           one_lambda * implicit_lambda_Pa(p.least.lambda_Pa);
}

/// Widens the extent to the grid points within the bounds of an inclusion.
void widen(const Domain& domain, const Bounds& box, CellExtent& extent) {
    const auto range = [&](double low_m, double high_m, double first_m, std::ptrdiff_t points,
                           std::ptrdiff_t& begin, std::ptrdiff_t& end) {
        const double n = static_cast<double>(points);
        const auto cell = [&](double at_m) {
            return std::clamp((at_m - first_m) / domain.spacing_m + 0.5, 0.0, n);
        };
        const auto from = static_cast<std::ptrdiff_t>(std::floor(cell(low_m))),
                   to = static_cast<std::ptrdiff_t>(std::ceil(cell(high_m)));
        begin = end == begin ? from : std::min(begin, from);
        end = std::max(end, to);
    };
    range(box.low_m.x, box.high_m.x, domain.x_m(0), domain.nx, extent.x_begin, extent.x_end);
    range(box.low_m.y, box.high_m.y, domain.y_m(0), domain.ny, extent.y_begin, extent.y_end);
}

/// Counts the cells at a point. All cells of the plane are kept if the layer itself exceeds the
/// minimum.
void count_cells(const Setting& s, const PointEstimate& p, const Material& layer, bool less_viscous,
                 VariationEstimate& v) {
    const Material& least = p.least;
    const bool whole = less_viscous || least.mu_Pa < layer.mu_Pa ||
                       least.density_kg_m3 < layer.density_kg_m3 ||
                       (lambda_varies(p) && least.lambda_Pa < layer.lambda_Pa);
    const double ny = static_cast<double>(s.c.domain.ny);
    const double plane = static_cast<double>(s.c.domain.nx) * ny, mine = s.rows * ny;
    if (whole) v.extent = {0, s.c.domain.nx, 0, s.c.domain.ny};
    v.points += 1.0;
    v.cells += whole ? plane : std::min(p.cells, plane);
    v.fullest_cells += whole ? mine : std::min(p.fullest, mine);
}

/// Follows the decisions of lateral_variation.cpp and the stabilisation of VerticalOperator. kappa
/// is the largest wavenumber.
void add_contrast(const Setting& s, const PointEstimate& p, double kappa_rad_m, Contrast& all) {
    const Material &least = p.least, &greatest = p.greatest;
    const double bears = least.density_kg_m3 / std::pow(kappa_rad_m * s.step_s, 2);
    const auto stable = [&](double mu_Pa) {
        return std::max(mu_Pa / 12.0, mu_Pa / 4.0 - 0.98 * bears);
    };
    const bool lambda = lambda_varies(p);
    all.of_lambda_or_viscosity |= lambda || greatest.viscosity_Pa_s > least.viscosity_Pa_s;
    all.of_density |= greatest.density_kg_m3 > least.density_kg_m3 * (1.0 + 1e-9);
    all.inertia =
        std::max(all.inertia, (stable(greatest.mu_Pa) - least.mu_Pa / 12.0) *
                                  std::pow(s.k_load_rad_m * s.step_s, 2) / least.density_kg_m3);
}

void add_element(const Setting& s, std::size_t element, VariationEstimate& v, Contrast& all) {
    const DepthMesh& mesh = s.mesh;
    if (!varies_between(s.c.scene().medium, mesh.ends_m[element], mesh.ends_m[element + 1])) return;
    const Material layer = material_of(s.c.scene().medium.layers[mesh.layers[element]]);
    const double kappa_rad_m =
        std::hypot(s.k_max_rad_m, std::sqrt(s.finest) * 2.0 / mesh.length_m(element));
    const std::vector<PointEstimate> points = points_of_element(s, element);
    for (const Inclusion& part : s.medium)
        if (part.box.high_m.z > mesh.ends_m[element] && part.box.low_m.z < mesh.ends_m[element + 1])
            widen(s.c.domain, part.box, v.extent);
    const bool less_viscous = std::any_of(points.begin(), points.end(), [&](const auto& p) {
        return p.least.viscosity_Pa_s < layer.viscosity_Pa_s;
    });
    for (const PointEstimate& p : points) {
        if (!p.varies && !less_viscous) continue;
        count_cells(s, p, layer, less_viscous, v);
        add_contrast(s, p, kappa_rad_m, all);
    }
}

} // namespace

VariationEstimate estimate_variation(const Case& c, const DepthMesh& mesh, double step_s,
                                     int ranks) {
    VariationEstimate v;
    if (c.scene().medium.bodies.empty() && !c.scene().medium.map) return v;
    const auto& options = std::get<SpectralOptions>(c.solver);
    const Setting setting{.c = c,
                          .mesh = mesh,
                          .step_s = step_s,
                          .rows = std::ceil(static_cast<double>(c.domain.nx) / ranks),
                          .k_max_rad_m =
                              std::numbers::sqrt2 * std::numbers::pi / c.domain.spacing_m,
                          .k_load_rad_m = bandwidth_rad_m(c.scene().load.footprint, 0.5),
                          .finest = finest_mode(mesh.rule),
                          .medium = inclusions_of(c.scene().medium)};
    Contrast contrast;
    for (std::size_t e = 0; e < mesh.elements(); ++e)
        add_element(setting, e, v, contrast);
    v.components = contrast.of_density ? all_components : strain_components;
    const bool too_much = contrast.of_lambda_or_viscosity || contrast.of_density ||
                          options.method == SpectralMethod::iterative ||
                          (options.method == SpectralMethod::automatic &&
                           contrast.inertia > tolerated_inertia(options));
    v.iterates = v.points > 0.0 && too_much;
    return v;
}

} // namespace shearwake::spectral
