#pragma once

#include "model/trajectory.hpp"

namespace shearwake {

/// How far along its path a Travel is, and how fast it moves along it (negative: back).
struct Progress {
    double arc_m = 0.0;
    double speed_m_s = 0.0;
};

/// Beyond the end of a path that is run through once it goes on, whatever happens there.
Progress progress(const Travel& travel, double t_s);

/// Arc length of one run: the path, or there and back.
double cycle_m(const Travel& travel);
/// Stops in one run: the corners it passes, and where it turns back.
std::ptrdiff_t stops(const Travel& travel);
/// The shortest arc between two stops, or twice that between a stop and an end that is none.
double shortest_between_stops_m(const Travel& travel);

/// Time of one run; infinity if it never ends [s].
double cycle_s(const Travel& travel);
/// The constant speed whose run takes `cycle_s`, dwelling and slowing included; not positive if the
/// dwelling alone takes as long.
double speed_of_cycle_m_s(const Travel& travel, double cycle_s);

} // namespace shearwake
