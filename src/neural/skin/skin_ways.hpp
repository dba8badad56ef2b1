// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/hand/polygon.hpp"

#include <functional>
#include <vector>

namespace shearwake::neural {

/// Path lengths of waves from every pin to a receptor [mm]; infinite if there is no path.
using SkinWays = std::function<std::vector<double>(Vec2 receptor_mm)>;

/// Straight lines on an unbounded flat sheet of skin.
SkinWays straight_ways(std::vector<Vec2> pins_mm);

/// Shortest paths that stay within an outline: around the corners between fingers, not across the
/// gap. A shortest path bends only at reflex corners of the outline. The paths are therefore found
/// exactly by Dijkstra's algorithm on the visibility graph. There are no paths from or to points
/// outside of the skin. Not collective.
SkinWays ways_within(const Polygon& outline_mm, std::vector<Vec2> pins_mm);

} // namespace shearwake::neural
