// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

#include <limits>
#include <vector>

namespace shearwake::spectral {

/// Minimum number of elements over the height of a curved body. Relative error of the surface field
/// (3 mm focus at 7 m/s over 12 mm, compared with elements of 0.5 mm): for an ellipsoid of 12 x 10
/// x 3 mm that is 16 times stiffer 1.3, 0.5, 0.3 and 0.15 % with 1, 2, 3 and 4 elements; if it is a
/// quarter as stiff 0.9 and 0.08 % with 1 and 4; for a cylinder of 8 mm that is 400 times stiffer
/// 3.1 and 1.9 %. Without element boundaries at its top and bottom the error for the first
/// ellipsoid is 50 %.
constexpr double elements_of_body = 2.0;

/// A part of a layer with a common limit on the length of its elements.
struct MeshPiece {
    std::size_t layer = 0;
    double top_m = 0.0, bottom_m = 0.0;
    double longest_m =
        std::numeric_limits<double>::infinity(); // of an element, set by the inclusions
    bool has_light_body = false;                 // a free rigid body, lighter than the layer
};

/// Divides the layers down to `depth_m` at the tops and bottoms of bodies and the map, where the
/// moduli jump and the motion has a kink that no polynomial resolves. Depths closer together than
/// `least_m` are merged. Element lengths are limited to half of a curved body, the edge width of a
/// smooth body, eight points of a map, or twenty times the inverse wavenumber of shear waves at
/// `omega_rad_s` in a body. Not collective.
std::vector<MeshPiece> mesh_pieces(const Case& c, double depth_m, double least_m, int degree,
                                   double omega_rad_s);

} // namespace shearwake::spectral
