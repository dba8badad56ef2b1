// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "problem/case/case.hpp"

#include <vector>

namespace shearwake::spectral {

/// A point of the surface of a body that represents a part of it.
struct SurfacePoint {
    Vec3 offset_m; // from the centre of the body
    Vec3 normal;   // outwards
    double area_m2;
};

/// Points about `spacing_m` apart on the surface of a lump, for the midpoint rule. A body that
/// crosses the domain has no ends. Not collective.
std::vector<SurfacePoint> surface_points(const Body& body, const Domain& domain, double spacing_m);

/// Distance of the points of a patch, and the radius of a patch, in spacings.
constexpr double patch_points = 0.4, patch_radius = 4.0;
/// The weight of a patch is (1 - x)^2 (1 - ring x), x = r^2/radius^2. Its negative ring
/// reduces the smoothing of forces that vary along the surface (2.5 would remove its second
/// moment), while forces that alternate from marker to marker vanish. Without the ring, forces with
/// three waves around a sphere of 6 spacings per radius are a quarter too small, and the stress
/// above it due to a focus of 6 spacings is in error by 5 % at two spacings instead of 2 %.
constexpr double patch_ring = 1.85;
/// The same on the outline of a section, where 3 would remove the second moment.
constexpr double section_ring = 2.6;
/// The forces of a patch are inside the surface by this part of the distance of the markers: a
/// patch smooths them, which acts like a layer further out. Calibrated with the ring by the stress
/// around a sphere of 6 spacings per radius.
constexpr double patch_inset = 0.4;

/// The forces of the markers of bodies, distributed over their surfaces: each over a patch around
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

/// The surface of a body, or the outline of its section, whose points have lengths as areas.
struct PatchedBody {
    Vec3 centre_m;
    std::vector<SurfacePoint> surface; // without what the base covers
    double inset;                      // of its markers, in spacings
};
struct PatchedMarker {
    std::size_t body;
    Vec3 offset_m; // from the centre
};
/// `ring` is the coefficient of the weight, patch_ring or section_ring. Not collective.
SurfacePatches surface_patches(const std::vector<PatchedBody>& bodies,
                               const std::vector<PatchedMarker>& markers, double spacing_m,
                               double ring);

} // namespace shearwake::spectral
