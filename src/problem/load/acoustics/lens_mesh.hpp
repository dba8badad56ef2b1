// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vec3.hpp"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace shearwake {

/// Columns of square cross-section on a plane: heights (i, j), y fastest; 0 or less: no column.
struct HeightMap {
    std::ptrdiff_t side = 0;
    double pixel_m = 0.0;
    std::vector<double> heights_m;
};

using Triangle = std::array<Vec3, 3>;

/// The surface of the columns, centred on the z axis, from z = 0 upwards; the corners of each
/// triangle are counterclockwise as seen from outside [m]. Closed: each edge occurs equally often
/// in both directions.
std::vector<Triangle> surface_of(const HeightMap& map);

/// A binary STL file in millimetres.
std::string binary_stl(const std::vector<Triangle>& triangles);

} // namespace shearwake
