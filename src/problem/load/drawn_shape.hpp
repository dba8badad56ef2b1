// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vec2.hpp"
#include "problem/load/modulation.hpp"

#include <vector>

namespace shearwake {

/// The shape that a modulation is intended to draw, as lines of points at most `step_m` apart,
/// including corners: the path of its first part that moves along one (for STP the path of the
/// centre, not the pattern), displaced by the parts that rest. Without a path, the line of its
/// first swing; if all parts rest, a single point. One line per focus.
std::vector<std::vector<Vec2>> drawn_shape(const Modulation& modulation, double step_m);

} // namespace shearwake
