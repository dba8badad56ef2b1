#pragma once

#include "neural/polygon.hpp"

#include <functional>
#include <vector>

namespace shearwake::neural {

/// The ways of waves from every pin to a receptor [mm]; infinite where there is none.
using SkinWays = std::function<std::vector<double>(Vec2 receptor_mm)>;

/// Straight lines: an endless flat sheet of skin.
SkinWays straight_ways(std::vector<Vec2> pins_mm);

/// The shortest ways that stay within an outline: around the corners between fingers, not across
/// the gap. A shortest way bends at corners of the outline that point inwards and nowhere else, so
/// these are found exactly, by Dijkstra's search over what sees what. From and to points off the
/// skin there is none.
SkinWays ways_within(const Polygon& outline_mm, std::vector<Vec2> pins_mm);

} // namespace shearwake::neural
