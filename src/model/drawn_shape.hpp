#pragma once

#include "base/vec2.hpp"
#include "model/modulation.hpp"

#include <vector>

namespace shearwake {

/// What a modulation means to draw, as lines of points at most `step_m` apart, corners among them:
/// the path of its first part that travels along one (of STP the path of the centre, not the
/// pattern) moved by the parts that rest. Without a travel the line of its first swing; where all
/// rests a single point. One line for each of several foci.
std::vector<std::vector<Vec2>> drawn_shape(const Modulation& modulation, double step_m);

} // namespace shearwake
