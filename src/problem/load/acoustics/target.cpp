// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/acoustics/target.hpp"

#include <cmath>

namespace shearwake {

double TargetImage::at(Vec2 at_m, double width_m) const {
    const double pixel_m = width_m / static_cast<double>(columns);
    const auto column = static_cast<std::ptrdiff_t>(
        std::floor(at_m.x / pixel_m + 0.5 * static_cast<double>(columns)));
    const auto row =
        static_cast<std::ptrdiff_t>(std::floor(0.5 * static_cast<double>(rows) - at_m.y / pixel_m));
    if (column < 0 || column >= columns || row < 0 || row >= rows) return 0.0;
    return greys[static_cast<std::size_t>(row * columns + column)];
}

bool is_inside(const std::vector<Vec2>& corners, Vec2 at) {
    bool inside = false;
    for (std::size_t i = 0, before = corners.size() - 1; i < corners.size(); before = i++) {
        const Vec2 a = corners[i], b = corners[before];
        if ((a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y))
            inside = !inside;
    }
    return inside;
}

} // namespace shearwake
