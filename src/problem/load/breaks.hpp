// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/load.hpp"

#include <vector>

namespace shearwake {

/// Where the focus is at time t [m]; an array moves its focus at its update rate.
Vec2 focus_m(const Load& load, double t_s);

/// An instant at which the load is not smooth: limits from both sides of its position and strength,
/// or of their first two derivatives in time, differ. Between two breaks the load is smooth.
struct Break {
    double time_s = 0.0;
    /// Change of the strength, or of the position in standard deviations of a Gaussian footprint
    /// times the strength, whichever is larger, at most 1; the same of the slopes, over `cell_s`;
    /// and of the curvatures, over its square.
    double jump = 0.0, kink = 0.0, bend = 0.0;
};

/// The breaks of a load in [from_s, to_s), ascending. Left out are those with a jump below 1e-4, a
/// kink below 1e-3 and a bend below 3e-3, and those without a jump that are less than `cell_s`
/// apart: the points of a sampled curve. Not collective.
std::vector<Break> breaks_of(const Load& load, double from_s, double to_s, double cell_s);

} // namespace shearwake
