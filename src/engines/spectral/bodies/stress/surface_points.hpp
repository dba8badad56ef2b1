// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

} // namespace shearwake::spectral
