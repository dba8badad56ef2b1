// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

#include <string>

namespace shearwake {

/// Periods of a frequency that a Hann window must contain to judge it.
inline constexpr double fewest_periods_in_window = 3.0;

/// The part of a transient run from which the level of sensation is computed. A level belongs to a
/// vibration that repeats, so there is none for a load that does not repeat in the window.
struct SensationWindow {
    double duration_s = 0.0;
    double end_s = 0.0;
    /// The window contains whole periods of the load: its lines are exact. Otherwise it is a Hann
    /// window that contains each part of the load at least three times.
    bool has_whole_periods = false;
    std::string reason; // why there is no level; empty: there is one
};

/// The window between `measure.settled_after` and `measure.at` of a run in the transient regime.
/// Not collective.
SensationWindow sensation_window(const Case& c);

} // namespace shearwake
