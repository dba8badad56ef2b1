#pragma once

#include "base/vec2.hpp"

#include <vector>

namespace shearwake::neural {

/// Corners of a closed shape without holes whose sides do not cross; either way round.
using Polygon = std::vector<Vec2>;

struct Box {
    Vec2 low, high;
};

double area(const Polygon& polygon);
Vec2 centroid(const Polygon& polygon);
Box bounding_box(const Polygon& polygon);
/// A point on a side may count as within or not.
bool contains(const Polygon& polygon, Vec2 point);

} // namespace shearwake::neural
