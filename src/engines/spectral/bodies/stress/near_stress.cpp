// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/stress/near_stress.hpp"

#include "problem/medium/material_field.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace shearwake::spectral {
namespace {

/// The sum over the points of the patches is accurate from this distance from the surface on, in
/// spacings. It is evaluated there for points that are closer.
constexpr double least_distance = 0.4;

} // namespace

double ratio_at(const Medium& medium, double depth_m) {
    for (std::size_t i = 0; i < medium.layers.size(); ++i)
        if (i + 1 == medium.layers.size() || depth_m <= depths(medium, i).bottom_m) {
            const Material m = material_of(medium.layers[i]);
            return m.lambda_Pa / m.mu_Pa;
        }
    return 0.0;
}

NearStress::NearStress(NearSolid solid) : solid_(std::move(solid)) {
    for (std::size_t depth = 0; depth < solid_.depths_m.size(); ++depth)
        points_.push_back(find_points(depth));
}

/// The distance of two points of the periodic domain.
Vec3 NearStress::between(Vec3 from_m, Vec3 to_m) const {
    const auto nearest = [](double distance_m, double period_m) {
        return distance_m - period_m * std::nearbyint(distance_m / period_m);
    };
    return {nearest(to_m.x - from_m.x, solid_.domain.extent_x_m()),
            nearest(to_m.y - from_m.y, solid_.domain.extent_y_m()), to_m.z - from_m.z};
}

/// Whether a point is outside all bodies and close to one. Moves it to least_distance.
bool NearStress::moves_out(Vec3& at_m) const {
    for (const auto& [body, box] : solid_.bodies)
        if (volume_fraction(body, body.centre_m + between(body.centre_m, at_m), {}) > 0.5)
            return false;
    double least_m = std::numeric_limits<double>::infinity();
    const SurfacePatches::Face* nearest = nullptr;
    for (const SurfacePatches::Face& face : solid_.patches.faces)
        if (const double distance_m = norm(between(face.at_m, at_m)); distance_m < least_m) {
            least_m = distance_m;
            nearest = &face;
        }
    const double h_m = solid_.domain.spacing_m;
    if (!nearest || least_m > reach * h_m) return false;
    const Vec3 offset_m = between(nearest->at_m, at_m), n = nearest->normal;
    const double height_m = offset_m.x * n.x + offset_m.y * n.y + offset_m.z * n.z;
    if (least_m < 2.0 * least_distance * h_m && height_m < least_distance * h_m)
        at_m = at_m + (least_distance * h_m - height_m) * n;
    return true;
}

std::vector<NearStress::Point> NearStress::find_points(std::size_t depth) const {
    std::vector<Point> all;
    const Domain& domain = solid_.domain;
    const fft::SlabShare& share = solid_.share;
    const double far_m = reach * domain.spacing_m, depth_m = solid_.depths_m[depth];
    std::vector<char> used(static_cast<std::size_t>(share.reals), 0);
    for (const auto& [body, box] : solid_.bodies) {
        if (depth_m < box.low_m.z - far_m || depth_m > box.high_m.z + far_m) continue;
        const Vec3 middle_m = 0.5 * (box.low_m + box.high_m),
                   half_m = 0.5 * (box.high_m - box.low_m) + Vec3{far_m, far_m, far_m};
        for (std::ptrdiff_t i = 0; i < share.x_count; ++i)
            for (std::ptrdiff_t j = 0; j < domain.ny; ++j) {
                Point p{.place = static_cast<std::size_t>(i * share.padded_ny + j),
                        .x = share.x_start + i,
                        .y = j,
                        .at_m = {domain.x_m(share.x_start + i), domain.y_m(j), depth_m},
                        .is_near = {}};
                const Vec3 offset_m = between(middle_m, p.at_m);
                if (std::abs(offset_m.x) > half_m.x || std::abs(offset_m.y) > half_m.y ||
                    used[p.place])
                    continue;
                used[p.place] = 1;
                const Vec3 grid_m = p.at_m;
                if (!moves_out(p.at_m)) continue;
                for (const Vec3& marker_m : solid_.marker_m)
                    p.is_near.push_back(norm(between(marker_m, grid_m)) <
                                        marker_reach * domain.spacing_m);
                all.push_back(std::move(p));
            }
    }
    return all;
}

/// Whether a point of a patch can belong to a marker within marker_reach.
bool NearStress::reaches(Vec3 r_m) const {
    return norm(r_m) <= (marker_reach + patch_radius + 1.0) * solid_.domain.spacing_m;
}

void NearStress::each_row(std::size_t depth, const std::function<void(Row&&)>& use) const {
    for (const Point& point : points_[depth])
        use(row(depth, point));
}

NearStress::Row NearStress::row(std::size_t depth, const Point& point) const {
    constexpr std::array units{Vec3{1.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0}, Vec3{0.0, 0.0, 1.0}};
    std::vector<ForceStress> of_marker(solid_.marker_m.size());
    for (const SurfacePatches::Point& p : solid_.patches.points) {
        const Vec3 r_m = between(p.at_m, point.at_m);
        if (!reaches(r_m)) continue;
        for (std::size_t f = 0; f < units.size(); ++f) {
            const Stress exact = solid_.exact(r_m, units[f]);
            for (const SurfacePatches::Share& share : p.shares)
                for (std::size_t c = 0; c < strain_components; ++c)
                    of_marker[share.marker][f][c] += share.weight * exact[c];
        }
    }
    Row row{point.place, {}};
    for (std::size_t m = 0; m < of_marker.size(); ++m) {
        if (!point.is_near[m]) continue;
        const ForceStress of_engine = solid_.of_engine(depth, point.x, point.y, m);
        for (std::size_t f = 0; f < units.size(); ++f)
            for (std::size_t c = 0; c < strain_components; ++c)
                of_marker[m][f][c] -= of_engine[f][c];
        row.entries.push_back({m, of_marker[m]});
    }
    return row;
}

/// Adds the stress of the forces on the patches.
void NearStress::add_patches(const Point& point, const std::vector<Vec3>& forces,
                             Stress& sum) const {
    for (const SurfacePatches::Point& p : solid_.patches.points) {
        const Vec3 r_m = between(p.at_m, point.at_m);
        if (!reaches(r_m)) continue;
        Vec3 force{};
        for (const SurfacePatches::Share& share : p.shares)
            force = force + share.weight * forces[share.marker];
        if (norm(force) == 0.0) continue; // its markers are far away
        const Stress stress = solid_.exact(r_m, force);
        for (std::size_t c = 0; c < strain_components; ++c)
            sum[c] += stress[c];
    }
}

/// Subtracts the stress that the engine computes for the same forces.
void NearStress::add_engine(std::size_t depth, const Point& point, const std::vector<Vec3>& forces,
                            Stress& sum) const {
    for (std::size_t m = 0; m < forces.size(); ++m) {
        if (!point.is_near[m]) continue;
        const ForceStress unit = solid_.of_engine(depth, point.x, point.y, m);
        const Vec3 f = forces[m];
        for (std::size_t c = 0; c < strain_components; ++c)
            sum[c] -= unit[0][c] * f.x + unit[1][c] * f.y + unit[2][c] * f.z;
    }
}

std::vector<StressCorrection::Change> NearStress::changes(std::size_t depth,
                                                          const std::vector<double>& forces) const {
    std::vector<Vec3> near_forces(solid_.marker_m.size());
    std::vector<StressCorrection::Change> all;
    for (const Point& p : points_[depth]) {
        StressCorrection::Change change{p.place, {}};
        for (std::size_t m = 0; m < near_forces.size(); ++m)
            near_forces[m] =
                p.is_near[m] ? Vec3{forces[3 * m], forces[3 * m + 1], forces[3 * m + 2]} : Vec3{};
        add_patches(p, near_forces, change.stress_Pa);
        add_engine(depth, p, near_forces, change.stress_Pa);
        all.push_back(change);
    }
    return all;
}

} // namespace shearwake::spectral
