// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/lump_bodies.hpp"
#include "engines/spectral/bodies/surface_points.hpp"

namespace shearwake::spectral {

/// Distance of the points of a patch, and the radius of a patch, in spacings.
constexpr double patch_points = 0.4, patch_radius = 4.0;
/// The weight of a patch is (1 - x)^2 (1 - patch_ring x), x = r^2/radius^2. Its negative ring
/// reduces the smoothing of forces that vary along the surface (2.5 would remove its second
/// moment), while forces that alternate from marker to marker vanish. Without the ring, forces with
/// three waves around a sphere of 6 spacings per radius are a quarter too small, and the stress
/// above it due to a focus of 6 spacings is in error by 5 % at two spacings instead of 2 %.
constexpr double patch_ring = 1.85;
/// The forces of a patch are inside the surface by this part of the distance of the markers: a
/// patch smooths them, which acts like a layer further out. Calibrated with the ring by the stress
/// around a sphere of 6 spacings per radius.
constexpr double patch_inset = 0.4;

/// The forces of the markers of lumps, distributed over their surfaces: each over a patch around
/// the marker, without the opposite side of a thin body.
/// Markers inside a body keep their places.
struct SurfacePatches {
    struct Share {
        std::size_t marker;
        double weight; // the weights of a marker have the sum 1
    };
    struct Point {
        Vec3 at_m; // of the force
        std::vector<Share> shares;
    };
    /// A point of the true surface.
    struct Face {
        Vec3 at_m, normal;
    };
    std::vector<Point> points;
    std::vector<Face> faces;
};

/// For markers at these places above `base_m`. Not collective.
SurfacePatches surface_patches(const std::vector<Body>& bodies,
                               const std::vector<LumpBodies::Marker>& markers, const Domain& domain,
                               double base_m);

} // namespace shearwake::spectral
