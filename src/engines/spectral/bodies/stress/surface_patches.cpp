// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/stress/surface_patches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake::spectral {
namespace {

double dot(Vec3 a, Vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The patch of a marker at an offset from the centre: the indices of its points and their weights.
std::vector<std::pair<std::size_t, double>> patch_of(Vec3 marker_m,
                                                     const std::vector<SurfacePoint>& surface,
                                                     const std::vector<Vec3>& markers_surface_m,
                                                     double spacing_m, double ring) {
    std::vector<std::pair<std::size_t, double>> patch;
    double least_m = std::numeric_limits<double>::infinity();
    Vec3 normal;
    for (const SurfacePoint& p : surface)
        if (const double distance_m = norm(p.offset_m - marker_m); distance_m < least_m) {
            least_m = distance_m;
            normal = p.normal;
        }
    if (least_m > spacing_m) return patch; // inside
    double sum = 0.0;
    for (std::size_t i = 0; i < surface.size(); ++i) {
        const double x =
            std::pow(norm(markers_surface_m[i] - marker_m) / (patch_radius * spacing_m), 2);
        if (x >= 1.0 || dot(surface[i].normal, normal) < -0.1) continue;
        const double weight = std::pow(1.0 - x, 2) * (1.0 - ring * x);
        patch.push_back({i, weight * surface[i].area_m2});
        sum += patch.back().second;
    }
    for (auto& [point, weight] : patch)
        weight /= sum;
    return patch;
}

} // namespace

SurfacePatches surface_patches(const std::vector<PatchedBody>& bodies,
                               const std::vector<PatchedMarker>& markers, double spacing_m,
                               double ring) {
    SurfacePatches all;
    for (std::size_t body = 0; body < bodies.size(); ++body) {
        const auto& [centre_m, surface, inset] = bodies[body];
        const std::size_t first = all.points.size();
        std::vector<Vec3> markers_surface_m;
        for (const SurfacePoint& p : surface) {
            const Vec3 inwards_m =
                (-inset * spacing_m * std::hypot(p.normal.x, p.normal.y)) * p.normal;
            markers_surface_m.push_back(p.offset_m + inwards_m);
            all.points.push_back({centre_m + p.offset_m + patch_inset * inwards_m, {}});
            all.faces.push_back({centre_m + p.offset_m, p.normal});
        }
        for (std::size_t m = 0; m < markers.size(); ++m) {
            if (markers[m].body != body) continue;
            const auto patch =
                patch_of(markers[m].offset_m, surface, markers_surface_m, spacing_m, ring);
            for (const auto& [point, weight] : patch)
                all.points[first + point].shares.push_back({m, weight});
            if (patch.empty()) all.points.push_back({centre_m + markers[m].offset_m, {{m, 1.0}}});
        }
    }
    std::erase_if(all.points, [](const SurfacePatches::Point& p) { return p.shares.empty(); });
    return all;
}

} // namespace shearwake::spectral
