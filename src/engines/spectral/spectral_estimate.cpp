#include "engines/spectral/spectral_estimate.hpp"

#include "engines/spectral/cell_materials.hpp"
#include "engines/spectral/lanes.hpp"
#include "engines/spectral/lateral_sponge.hpp"
#include "engines/spectral/lateral_variation.hpp"
#include "engines/spectral/receptor_stress.hpp"
#include "engines/spectral/skyline_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

/// Seconds a point, frame and plane of the stress at receptors: its sums and its transform.
constexpr double felt_s = 2e-8;
/// As many places of the map are looked at.
constexpr std::ptrdiff_t map_samples = 500;

/// A box where the medium may differ from the layers, and the materials within.
struct Inclusion {
    Bounds box;
    double filled;                                // share of the box's plane
    std::vector<std::vector<Material>> materials; // of each layer
};

Inclusion inclusion_of(const Medium& medium, const Body& body) {
    constexpr double of_ellipse = std::numbers::pi / 4.0;
    Inclusion part{
        bounds(body), std::holds_alternative<Ellipsoid>(body.shape) ? of_ellipse : 1.0, {}};
    for (std::size_t layer = 0; layer < medium.layers.size(); ++layer)
        part.materials.push_back({material_of_cell(medium, layer, body.centre_m, {})});
    return part;
}

Inclusion inclusion_of(const Medium& medium, const MaterialMap& map) {
    Inclusion part{{}, 1.0, std::vector<std::vector<Material>>(medium.layers.size())};
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

/// Least and greatest at a strain point, and what fills its plane.
struct PointEstimate {
    Material least, greatest;
    double cells = 0.0, fullest = 0.0;
    bool varies = false;
};

/// Cells of a box in the plane, of all ranks and of the slab of rows that has most.
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
    const Material layer = material_of(c.medium.layers[layer_at]);
    const HeldMaterials held(c, layer);
    PointEstimate point{.least = layer, .greatest = layer};
    const auto widen = [](double value, double& least, double& greatest) {
        least = std::min(least, value);
        greatest = std::max(greatest, value);
    };
    for (const Inclusion& part : medium) {
        if (part.box.high_m.z <= top_m || part.box.low_m.z >= bottom_m) continue;
        for (const Material& material : part.materials[layer_at]) {
            const Material m = held(material);
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

} // namespace

VariationEstimate estimate_variation(const Case& c, const DepthMesh& mesh, double step_s,
                                     int ranks) {
    VariationEstimate v;
    if (c.medium.bodies.empty() && !c.medium.map) return v;
    const auto& options = std::get<SpectralOptions>(c.solver);
    const std::vector<Inclusion> medium = inclusions_of(c.medium);
    const double plane = static_cast<double>(c.domain.nx * c.domain.ny);
    const double rows = std::ceil(static_cast<double>(c.domain.nx) / ranks);
    const double finest = finest_mode(mesh.rule);
    const double k_max = std::numbers::sqrt2 * std::numbers::pi / c.domain.spacing_m;
    const double k_load = bandwidth_rad_m(c.load.footprint, 0.5);
    bool must = false, density = false;
    double inertia = 0.0, stiffness = 0.0; // the operator beyond its background, relative to it
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        if (!varies_between(c.medium, mesh.ends_m[e], mesh.ends_m[e + 1])) continue;
        const Material layer = material_of(c.medium.layers[mesh.layers[e]]);
        const double kappa = std::hypot(k_max, std::sqrt(finest) * 2.0 / mesh.length_m(e));
        std::vector<PointEstimate> points;
        for (std::size_t i = 0; i < mesh.rule.nodes.size(); ++i) {
            const DepthCell cell = depth_cell(mesh, e, i);
            points.push_back(estimate_point(c, medium, mesh.layers[e],
                                            cell.centre_m - 0.5 * cell.size_m,
                                            cell.centre_m + 0.5 * cell.size_m, rows));
        }
        const bool less_viscous =
            std::any_of(points.begin(), points.end(), [&](const PointEstimate& p) {
                return p.least.viscosity_Pa_s < layer.viscosity_Pa_s;
            });
        for (const PointEstimate& p : points) {
            if (!p.varies && !less_viscous) continue;
            const Material &least = p.least, &greatest = p.greatest;
            // Where the layer itself is more than the least, every cell is kept.
            const bool whole = less_viscous || least.mu_Pa < layer.mu_Pa ||
                               least.density_kg_m3 < layer.density_kg_m3 ||
                               (greatest.lambda_Pa > one_lambda * least.lambda_Pa &&
                                least.lambda_Pa < layer.lambda_Pa);
            v.points += 1.0;
            v.cells += whole ? plane : std::min(p.cells, plane);
            v.fullest_cells += whole ? rows * static_cast<double>(c.domain.ny)
                                     : std::min(p.fullest, rows * static_cast<double>(c.domain.ny));
            // As lateral_variation.cpp decides and VerticalOperator stabilises.
            const double bears = least.density_kg_m3 / std::pow(kappa * step_s, 2);
            const auto stable = [&](double mu_Pa) {
                return std::max(mu_Pa / 12.0, mu_Pa / 4.0 - 0.98 * bears);
            };
            const bool lambda = greatest.lambda_Pa > one_lambda * least.lambda_Pa;
            const bool viscosity = greatest.viscosity_Pa_s > least.viscosity_Pa_s;
            density |= greatest.density_kg_m3 > least.density_kg_m3 * (1.0 + 1e-9);
            must |= lambda || viscosity;
            inertia = std::max(inertia, (stable(greatest.mu_Pa) - least.mu_Pa / 12.0) *
                                            std::pow(k_load * step_s, 2) / least.density_kg_m3);
            const double shear =
                (stable(greatest.mu_Pa) - stable(least.mu_Pa) +
                 0.5 * (greatest.viscosity_Pa_s - least.viscosity_Pa_s) / step_s) /
                (stable(least.mu_Pa) + 0.5 * least.viscosity_Pa_s / step_s + bears);
            stiffness =
                std::max({stiffness, shear, greatest.density_kg_m3 / least.density_kg_m3 - 1.0,
                          lambda ? greatest.lambda_Pa / least.lambda_Pa - 1.0 : 0.0});
        }
    }
    v.components = density ? all_components : strain_components;
    const bool iterates =
        v.points > 0.0 &&
        (must || density || options.method == SpectralMethod::iterative ||
         (options.method == SpectralMethod::automatic && inertia > tolerated_inertia(options)));
    // Fitted to 48 x 36 points, contrasts 2 to 400, steps of 12.5 to 100 us, viscosities, densities
    // and c_p that vary: within a factor of 2.6. Logarithmic in the residual as any such iteration.
    if (iterates)
        v.iterations = std::max(1.0, 2.2 * std::sqrt(stiffness) * std::log(2.0 / options.residual) /
                                         std::log(2.0 / 1e-3));
    return v;
}

Estimate estimate_spectral(const Case& c, const DepthMesh& mesh, std::ptrdiff_t steps_per_frame,
                           int ranks) {
    const double step_s = c.time.interval_s / static_cast<double>(steps_per_frame);
    const VariationEstimate v = estimate_variation(c, mesh, step_s, ranks);
    const auto up = [](double a, double b) { return std::ceil(a / b); };
    const double nx = static_cast<double>(c.domain.nx), ny = static_cast<double>(c.domain.ny);
    const double modes_y = static_cast<double>(c.domain.ny / 2 + 1), points = nx * ny;
    const double levels = static_cast<double>(mesh.levels() - 1), nodes = mesh.degree + 1.0;
    const double frames = static_cast<double>(c.time.frames);
    const double snapshots = static_cast<double>(c.record.volumes_s.size());
    const double planes = v.points * v.components;
    const bool tensors = std::any_of(c.record.volume_fields.begin(), c.record.volume_fields.end(),
                                     [](VolumeField f) { return f != VolumeField::u; });
    const double felt = ReceptorStress::planes(c, mesh);
    Estimate e;
    e.useful_ranks = static_cast<int>(std::min(c.domain.nx, c.domain.ny / 2 + 1));

    const double pencil_lanes = up(modes_y, ranks) * up(nx / 2.0, lane_count);
    const double displacement_B = pencil_lanes * 3.0 * levels * parts * sizeof(Lanes);
    const auto moving = static_cast<std::ptrdiff_t>(mesh.levels() - 1);
    const auto entries = SkylineMatrix(moving, mesh.degree, 2).entries() +
                         SkylineMatrix(moving, mesh.degree, 1).entries();
    const double factors_B = pencil_lanes * static_cast<double>(entries) * sizeof(Lanes);
    const double plane_B =
        2.0 * sizeof(double) * std::max(up(nx, ranks) * modes_y, nx * up(modes_y, ranks));
    const double arrays = (v.iterations > 0.0 ? 7.0 : 4.0) * v.components + 3.0 +
                          (v.iterations > 0.0 ? v.components / 3.0 : 0.0); // then the moduli
    const double map_B = c.medium.map ? static_cast<double>(c.medium.map->c_s_m_s.size() +
                                                            c.medium.map->c_p_m_s.size() +
                                                            c.medium.map->density_kg_m3.size() +
                                                            c.medium.map->viscosity_Pa_s.size()) *
                                            sizeof(double)
                                      : 0.0;
    const double sampled_B = v.points * up(nx, ranks) * ny * sizeof(Material);
    const SpongePlan sponge = sponge_plan(c, !(v.points > 0.0), step_s);
    const double sponge_values = sponge.every > 0 ? 3.0 * levels * static_cast<double>(sponge.nx) *
                                                        static_cast<double>(sponge.ny)
                                                  : 0.0;
    const double sponge_B =
        sponge_values * sizeof(double) / std::min<double>(ranks, static_cast<double>(sponge.ny));
    const double stepper_B = factors_B + 2.0 * displacement_B + planes * plane_B + sponge_B +
                             arrays * v.fullest_cells * sizeof(double);
    // The program itself; the transform's own planes and the engine's. Materials are gathered
    // before there is anything else, and forgotten.
    e.memory_per_rank_B = program_B + map_B + std::max(stepper_B, sampled_B) +
                          (ranks > 1 ? 3.0 : 2.0) * plane_B +
                          (tensors ? displacement_B + (24.0 + nodes) * plane_B : 0.0) +
                          (felt > 0.0 ? (2.0 + 2.0 * felt) * plane_B : 0.0);

    // Seconds per mode, level and node of an element; per plane and mode or point: measured with
    // `shearwake bench spectral`.
    const double modes = nx * modes_y, more = v.iterations > 0.0 ? v.iterations + 1.0 : 0.0;
    const double solves_s = modes * levels * nodes * (2.8e-9 + 1.9e-9 * more);
    // Along y only rows with cells: of a bar along x the square root is too many, never too few.
    const double rows =
        v.points > 0.0 ? std::sqrt(std::min(1.0, v.cells / (v.points * points))) : 0.0;
    const double each_way = planes * ((0.9e-9 + 0.85e-9 * rows) * points + 1.6e-9 * modes);
    const double values_s = 1e-8 * v.cells * v.components * (1.0 + more);
    const double sponge_s =
        sponge.every > 0 ? 1.1e-8 * sponge_values / static_cast<double>(sponge.every) : 0.0;
    const double step_seconds = solves_s + 2.0 * each_way * (1.0 + more) + values_s + sponge_s;
    const double begin_s = modes * levels * nodes * nodes * 4e-9 + 1.5e-7 * v.points * points;
    const double volumes_s = snapshots * levels * points * (tensors ? 1e-7 : 1e-8);
    e.seconds = begin_s + volumes_s + step_seconds * frames * static_cast<double>(steps_per_frame) +
                7e-9 * points * frames * static_cast<double>(c.measure.depths_m.size()) +
                felt_s * points * frames * felt;
    return e;
}

} // namespace shearwake
