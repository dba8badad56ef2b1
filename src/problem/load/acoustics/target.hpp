// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vec2.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace shearwake {

/// A grey-scale picture of the radiation pressure to be produced. Shared by the cases of a sweep.
struct TargetImage {
    std::ptrdiff_t columns = 0, rows = 0;
    std::vector<double> greys; // row by row from the top (largest y), 0: black, 1: white
    std::string content_hash;

    /// The grey value at a point of the picture of this width that is centred on the origin; 0
    /// outside.
    double at(Vec2 at_m, double width_m) const;
};

/// Whether the closed polygon with these corners contains a point (even-odd rule).
bool is_inside(const std::vector<Vec2>& corners, Vec2 at);

} // namespace shearwake
