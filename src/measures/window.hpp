#pragma once

#include "model/case.hpp"

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace shearwake {

/// Weights w_n, one per frame, in units of frames, such that sum_n w_n f(t_n) interval is the
/// integral over [from, to] of the straight-line interpolant of f with f = 0 at t = 0. The ends
/// may fall between frames; what lies outside [0, duration] counts nothing.
std::vector<double> window_weights(const TimeAxis& time, double from_s, double to_s);

/// The span of time that a period reading covers, or the reason why there is none.
struct PeriodWindow {
    double from_s = 0.0;
    double to_s = 0.0;
    int periods = 0; // whole modulation periods; 0: no modulation
    std::string reason;
    bool fits() const { return reason.empty(); }
};

/// Fewer frames than this in a modulation period do not follow it.
constexpr double fewest_frames_a_period = 4.0;

/// The largest whole number of modulation periods after `settled_after`, ending at `at`; without
/// modulation all that is settled. A reason when not even one fits, when `at` lies beyond the run,
/// and when the frames are too far apart to follow a period.
/// And when the load has gone out (off_s) more than a frame before the instant: nothing is at the
/// focus then.
PeriodWindow period_window(const MeasureOptions& measure, const TimeAxis& time,
                           std::optional<double> modulation_frequency_Hz,
                           double off_s = std::numeric_limits<double>::infinity());

/// Why there is no focus at the instant; empty if there is one.
std::string no_focus_reason(const MeasureOptions& measure, const TimeAxis& time, double off_s);

} // namespace shearwake
