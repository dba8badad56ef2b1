// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vec2.hpp"

#include <vector>

namespace shearwake::neural {

/// Corners of a simple polygon without holes, in either orientation.
using Polygon = std::vector<Vec2>;

/// An axis-parallel rectangle.
struct Box {
    Vec2 low, high;
};

/// Area, centroid and bounding box of a polygon, in its units. Not collective.
double area(const Polygon& polygon);
Vec2 centroid(const Polygon& polygon);
Box bounding_box(const Polygon& polygon);
/// Whether the point is inside. The result for a point on a side is unspecified. Not collective.
bool contains(const Polygon& polygon, Vec2 point);

} // namespace shearwake::neural
