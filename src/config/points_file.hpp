#pragma once

#include "base/vec2.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// Points out of a CSV file, or why there are none.
struct PointsFile {
    std::vector<Vec2> points_m;
    std::string problem;
};

/// A first line that names the columns with their unit, such as "x_mm,y_mm", then one point a line;
/// empty lines and those that begin with # are passed over. At least 2 points and at most 100 000,
/// all finite, none where the one before it is.
PointsFile read_points(std::string_view csv);

} // namespace shearwake
