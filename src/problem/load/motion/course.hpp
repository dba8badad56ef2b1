// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/motion/trajectory.hpp"

namespace shearwake {

/// The arc length of a Travel along its path, and its speed (negative: backwards). Both are smooth
/// functions of time while `pass` and `stage` do not change: `stage` counts the parts of a pass
/// between rests and changes of the acceleration.
struct PathProgress {
    double arc_m = 0.0;
    double speed_m_s = 0.0;
    double pass = 0.0;
    std::ptrdiff_t stage = 0; // of rests: the number of the rest
};

/// Continues beyond the end of a path that is traversed once, independent of AtEnd.
PathProgress progress(const Travel& travel, double t_s);

/// Whether the path is traversed again after its end.
bool runs_again(const Travel& travel);
/// Arc length of one pass: the path, or there and back.
double cycle_m(const Travel& travel);
/// Number of stops in one pass: the corners, and the points at which it reverses.
std::ptrdiff_t stops(const Travel& travel);
/// The shortest arc between two stops, or twice that between a stop and an end without a stop.
double shortest_between_stops_m(const Travel& travel);

/// Duration of one pass; infinity if it never ends [s].
double cycle_s(const Travel& travel);
/// The constant speed for which one pass takes `cycle_s`, including rests and slow parts; not
/// positive if the rests alone take this time.
double speed_of_cycle_m_s(const Travel& travel, double cycle_s);

} // namespace shearwake
