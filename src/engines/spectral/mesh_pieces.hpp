#pragma once

#include "model/case.hpp"

#include <limits>
#include <vector>

namespace shearwake {

/// Curved bodies are cut into at least as many elements over their height. The surface field (3 mm
/// focus at 7 m/s over 12 mm, against elements of 0.5 mm) is off, for an ellipsoid of 12 x 10 x 3
/// mm 16 times stiffer, by 1.3, 0.5, 0.3 and 0.15 % with 1, 2, 3 and 4; a quarter as stiff by 0.9
/// and 0.08 % with 1 and 4; a cylinder of 8 mm 400 times stiffer by 3.1 and 1.9 %. Without ends at
/// its top and bottom the first one is off by half.
constexpr double elements_of_body = 2.0;

/// A part of a layer whose elements are of one kind.
struct MeshPiece {
    std::size_t layer = 0;
    double top_m = 0.0, bottom_m = 0.0;
    double longest_m =
        std::numeric_limits<double>::infinity(); // of an element, for what lies in it
};

/// The layers down to `depth_m`, cut where a body or the map begins and ends, for the moduli jump
/// there, and no polynomial follows the kink that the motion has. Depths that lie closer than
/// `least_m` together are one. Elements within are no longer than half of a curved body, the
/// edge of a smooth one, eight points of a map, or twenty times the inverse wavenumber of shear
/// waves at `omega_rad_s` in a body.
std::vector<MeshPiece> mesh_pieces(const Case& c, double depth_m, double least_m, int degree,
                                   double omega_rad_s);

} // namespace shearwake
