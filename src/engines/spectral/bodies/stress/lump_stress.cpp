// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/stress/lump_stress.hpp"

#include "engines/spectral/bodies/lump_markers.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/bodies/section_markers.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::spectral {
namespace {

std::vector<Vec3> marker_places(const LumpBodies& lumps) {
    std::vector<Vec3> all;
    for (const LumpBodies::Marker& m : lumps.markers())
        all.push_back(lumps.lumps()[m.body].centre_m + m.offset_m);
    return all;
}

std::vector<double> marker_depths(const LumpBodies& lumps) {
    std::vector<double> all;
    for (const LumpBodies::Marker& m : lumps.markers())
        if (m.depth == all.size()) all.push_back(lumps.lumps()[m.body].centre_m.z + m.offset_m.z);
    return all;
}

/// The distance of two indices on a periodic axis, in [-period/2, period/2].
std::ptrdiff_t nearest_image(std::ptrdiff_t distance, std::ptrdiff_t period) {
    distance = (distance % period + period) % period;
    return 2 * distance > period ? distance - period : distance;
}

/// The stress that the engine computes at a point of the grid for unit forces at a marker.
ForceStress stress_of(const LumpBodies::Marker& m, const GridForces& grid, const Domain& domain,
                      std::size_t depth, std::ptrdiff_t x, std::ptrdiff_t y) {
    ForceStress sum{};
    for (std::ptrdiff_t i = 0; i < kernel_points; ++i)
        for (std::ptrdiff_t j = 0; j < kernel_points; ++j) {
            const double weight =
                m.along_x[static_cast<std::size_t>(i)] * m.along_y[static_cast<std::size_t>(j)];
            const ForceStress one =
                grid.at(depth, m.depth, nearest_image(x - (m.x + i - 1), domain.nx),
                        nearest_image(y - (m.y + j - 1), domain.ny));
            for (std::size_t f = 0; f < 3; ++f)
                for (std::size_t c = 0; c < strain_components; ++c)
                    sum[f][c] += weight * one[f][c];
        }
    return sum;
}

SurfacePatches lump_patches(const LumpBodies& lumps, const Domain& domain, double base_m) {
    std::vector<PatchedBody> bodies;
    for (const Body& body : lumps.lumps()) {
        bodies.push_back({body.centre_m,
                          surface_points(body, domain, patch_points * domain.spacing_m),
                          std::holds_alternative<Box>(body.shape) ? flat_inset : curved_inset});
        std::erase_if(bodies.back().surface, [&](const SurfacePoint& p) {
            return body.centre_m.z + p.offset_m.z > base_m;
        });
    }
    std::vector<PatchedMarker> markers;
    for (const LumpBodies::Marker& m : lumps.markers())
        markers.push_back({m.body, m.offset_m});
    return surface_patches(bodies, markers, domain.spacing_m, patch_ring);
}

NearSolid around(const LumpBodies& lumps, double lambda_per_mu, const Domain& domain,
                 const DepthMesh& mesh, const fft::SlabShare& share,
                 const std::vector<double>& depths_m, const GridForces& grid) {
    NearSolid solid{
        .bodies = {},
        .domain = domain,
        .share = share,
        .depths_m = depths_m,
        .patches = lump_patches(lumps, domain, mesh.ends_m.back()),
        .marker_m = marker_places(lumps),
        .of_engine =
            [&lumps, &grid, domain](std::size_t depth, std::ptrdiff_t x, std::ptrdiff_t y,
                                    std::size_t marker) {
                return stress_of(lumps.markers()[marker], grid, domain, depth, x, y);
            },
        .exact = [lambda_per_mu](Vec3 r_m,
                                 Vec3 force) { return kelvin_stress(r_m, lambda_per_mu, force); }};
    for (const Body& body : lumps.lumps())
        solid.bodies.push_back({body, bounds(lump_in(body, domain))});
    return solid;
}

} // namespace

LumpStress::LumpStress(const LumpBodies& lumps, const Medium& medium, const Domain& domain,
                       const DepthMesh& mesh, const fft::SlabShare& share,
                       std::vector<double> depths_m, Corrected use)
    : grid_(mesh, domain.spacing_m, ratio_at(medium, lumps.lumps().front().centre_m.z),
            marker_depths(lumps), depths_m),
      near_(around(lumps, ratio_at(medium, lumps.lumps().front().centre_m.z), domain, mesh, share,
                   depths_m, grid_)),
      rows_(depths_m.size()) {
    if (use != Corrected::zz) return;
    for (std::size_t depth = 0; depth < rows_.size(); ++depth)
        near_.each_row(depth, [&](NearStress::Row&& all) {
            Row row{all.place, {}};
            for (const auto& [marker, per_force] : all.entries)
                row.entries.push_back(
                    {marker, {per_force[0][zz], per_force[1][zz], per_force[2][zz]}});
            rows_[depth].push_back(std::move(row));
        });
}

void LumpStress::add_zz(std::size_t depth, double factor, double* plane) const {
    for (const Row& row : rows_[depth]) {
        double sum = 0.0;
        for (const Entry& entry : row.entries)
            for (std::size_t f = 0; f < 3; ++f)
                sum += entry.weights[f] * forces_[3 * entry.marker + f];
        plane[row.place] += factor * sum;
    }
}

namespace {

/// Points of the patches per marker.
constexpr double points_per_marker = 10.0;

/// Points of all levels of a volume that are corrected.
double volume_points(const Case& c, const DepthMesh& mesh) {
    const double far_m = NearStress::reach * c.domain.spacing_m;
    double points = 0.0;
    for (const Body& body : lump_bodies(c)) {
        const Bounds box = bounds(lump_in(body, c.domain));
        const Vec3 length_m = box.high_m - box.low_m + Vec3{2 * far_m, 2 * far_m, 2 * far_m};
        double levels = 0.0;
        for (std::size_t level = 0; level < mesh.clear_levels(); ++level)
            if (std::abs(mesh.z_m(level) - body.centre_m.z) < 0.5 * length_m.z) levels += 1.0;
        // Without the body and the corners, about half of the box.
        points += 0.5 * levels * std::min(length_m.x, c.domain.extent_x_m()) *
                  std::min(length_m.y, c.domain.extent_y_m()) /
                  (c.domain.spacing_m * c.domain.spacing_m);
    }
    return points;
}

} // namespace

double lump_stress_pairs(const Case& c, const DepthMesh& mesh) {
    if (!records_tensors(c.record) || lump_bodies(c).empty()) return 0.0;
    return volume_points(c, mesh) * points_per_marker * lump_sizes(c, mesh).markers;
}

double lump_stress_memory_B(const Case& c, const DepthMesh& mesh, int ranks) {
    const LumpSizes sizes = lump_sizes(c, mesh);
    const auto depths = static_cast<double>(stress_depths_m(c).size());
    const double volumes_B =
        records_tensors(c.record)
            ? GridForces::memory_B(sizes.depths, static_cast<double>(mesh.clear_levels())) +
                  volume_points(c, mesh) * (100.0 + sizes.markers / 8.0) / ranks
            : 0.0;
    if (sizes.markers == 0.0 || (depths == 0.0 && volumes_B == 0.0)) return 0.0;
    // Markers within marker_reach of a point: those of a surface that passes through it.
    const double near = std::min(sizes.markers, 300.0);
    const double points =
        std::min(sizes.points_x + 2.0 * NearStress::reach, static_cast<double>(c.domain.nx)) *
        std::min(sizes.points_y + 2.0 * NearStress::reach, static_cast<double>(c.domain.ny));
    const double of_patch =
        3.2 * std::pow(patch_radius / patch_points, 2) * sizeof(SurfacePatches::Share);
    return volumes_B + GridForces::memory_B(sizes.depths, depths) + sizes.markers * of_patch +
           depths * points * near * 4.0 * sizeof(double) / ranks;
}

} // namespace shearwake::spectral
