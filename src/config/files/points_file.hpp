// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace shearwake::config {

/// The points of a CSV file, or the reason why it was rejected.
struct PointsFile {
    std::vector<Vec2> points_m;
    std::string problem;
};

/// The first line names the columns with their unit, such as "x_mm,y_mm", followed by one point per
/// line; empty lines and lines that begin with # are ignored. At least 2 points and at most 100
/// 000, all finite and each different from the previous one.
PointsFile read_points(std::string_view csv);

} // namespace shearwake::config
