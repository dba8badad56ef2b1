// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/lump_bodies.hpp"
#include "engines/spectral/bodies/lump_markers.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/bodies/section_markers.hpp"
#include "engines/spectral/bodies/stress/near_stress.hpp"

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
                          inset_of(body)});
        std::erase_if(bodies.back().surface, [&](const SurfacePoint& p) {
            return body.centre_m.z + p.offset_m.z > base_m;
        });
    }
    std::vector<PatchedMarker> markers;
    for (const LumpBodies::Marker& m : lumps.markers())
        markers.push_back({m.body, m.offset_m});
    return surface_patches(bodies, markers, domain.spacing_m, patch_ring);
}

NearSolid around(const LumpBodies& lumps, const CorrectedPlanes& planes, const GridForces& grid) {
    const Domain domain = planes.domain;
    const double lambda_per_mu = ratio_at(planes.medium, lumps.lumps().front().centre_m.z);
    NearSolid solid{
        .bodies = {},
        .domain = domain,
        .share = planes.share,
        .depths_m = planes.depths_m,
        .patches = lump_patches(lumps, domain, planes.mesh.ends_m.back()),
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

/// The correction around lumps.
class LumpStress : public StressCorrection {
public:
    /// add_zz() is available for Corrected::zz, and changes() for all components. Not collective.
    LumpStress(const LumpBodies& lumps, const CorrectedPlanes& planes);

    void set_forces(const std::vector<double>& step_forces) override { forces_ = step_forces; }
    void add_zz(std::size_t depth, double factor, double* plane) const override;
    std::vector<Change> changes(std::size_t depth) const override {
        return near_.changes(depth, forces_);
    }

private:
    struct Entry {
        std::size_t marker;
        std::array<double, 3> weights;
    };
    struct Row {
        std::size_t place;
        std::vector<Entry> entries;
    };
    GridForces grid_;
    NearStress near_;
    std::vector<std::vector<Row>> rows_; // per depth: the matrix of sigma_zz
    std::vector<double> forces_;         // [marker][x, y, z]
};

LumpStress::LumpStress(const LumpBodies& lumps, const CorrectedPlanes& planes)
    : grid_(planes.mesh, planes.domain.spacing_m,
            ratio_at(planes.medium, lumps.lumps().front().centre_m.z), marker_depths(lumps),
            planes.depths_m),
      near_(around(lumps, planes, grid_)), rows_(planes.depths_m.size()) {
    if (planes.use != Corrected::zz) return;
    for (std::size_t depth = 0; depth < rows_.size(); ++depth)
        near_.each_row(depth, [&](NearStress::Row&& all) {
            Row row{all.place, {}};
            row.entries.reserve(all.entries.size());
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

/// Points of a plane that are corrected, and their pairs with markers next to them.
struct Corrections {
    double points = 0.0, pairs = 0.0;
};

/// Counts the corrections of a plane on a part of its points.
Corrections corrections_at(const RigidPlan& plan, const std::vector<Vec3>& markers_m,
                           double depth_m) {
    const Domain& domain = plan.c.domain;
    const double h_m = domain.spacing_m, far_m = NearStress::reach * h_m;
    constexpr int along = 16; // samples along x and y
    Corrections all;
    for (const Body& body : plan.bodies) {
        const Bounds box = bounds(lump_in(body, domain));
        if (depth_m < box.low_m.z - far_m || depth_m > box.high_m.z + far_m) continue;
        const auto step_m = [&](double low_m, double high_m, double extent_m) {
            return std::min(high_m - low_m + 2.0 * far_m, extent_m) / along;
        };
        const double x_m = step_m(box.low_m.x, box.high_m.x, domain.extent_x_m()),
                     y_m = step_m(box.low_m.y, box.high_m.y, domain.extent_y_m());
        const double share = x_m * y_m / (h_m * h_m); // points per sample
        for (int i = 0; i < along; ++i)
            for (int j = 0; j < along; ++j) {
                const Vec3 at_m{body.centre_m.x + (i + 0.5 - along / 2.0) * x_m,
                                body.centre_m.y + (j + 0.5 - along / 2.0) * y_m, depth_m};
                if (volume_fraction(body, at_m, {}) > 0.5) continue;
                double near = 0.0, least_m = far_m;
                for (const Vec3& marker_m : markers_m) {
                    const double distance_m = norm(marker_m - at_m);
                    least_m = std::min(least_m, distance_m);
                    if (distance_m < NearStress::marker_reach * h_m) near += 1.0;
                }
                if (least_m == far_m) continue;
                all.points += share;
                all.pairs += share * near;
            }
    }
    return all;
}

} // namespace

std::unique_ptr<StressCorrection> stress_correction(const LumpBodies* lumps,
                                                    CorrectedPlanes planes) {
    return std::make_unique<LumpStress>(*lumps, planes);
}

double lump_stress_memory_B(const RigidPlan& plan, const DepthMesh& mesh, int ranks) {
    const LumpSizes sizes = lump_sizes(plan, mesh);
    const std::vector<double> depths_m = stress_depths_m(plan.c);
    const bool tensors = records_tensors(plan.c.record);
    if (sizes.markers == 0.0 || (depths_m.empty() && !tensors)) return 0.0;
    const double of_patch =
        3.2 * std::pow(patch_radius / patch_points, 2) * sizeof(SurfacePatches::Share);
    double bytes = sizes.markers * of_patch +
                   GridForces::memory_B(sizes.depths, static_cast<double>(depths_m.size()));
    for (const double depth_m : depths_m)
        bytes +=
            corrections_at(plan, sizes.markers_m, depth_m).pairs * sizeof(double) * 4.0 / ranks;
    if (!tensors) return bytes;
    bytes += GridForces::memory_B(sizes.depths, static_cast<double>(mesh.clear_levels()));
    for (std::size_t level = 0; level < mesh.clear_levels(); ++level)
        bytes += corrections_at(plan, sizes.markers_m, mesh.z_m(level)).points *
                 (100.0 + sizes.markers / 8.0) / ranks;
    return bytes;
}

} // namespace shearwake::spectral
