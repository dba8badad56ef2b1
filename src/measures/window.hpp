// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "measures/surface_sums.hpp"
#include "problem/case/case.hpp"

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace shearwake::measures {

/// Weights w_n, one per frame, in units of frames, such that sum_n w_n f(t_n) interval is the
/// integral over [from, to] of the straight-line interpolant of f with f = 0 at t = 0. The ends may
/// be between frames; times outside [0, duration] do not contribute. With edge_s > 0, f is
/// multiplied by a trapezoid that rises from 0 to 1 in this time after `from`, and falls to 0
/// before `to`, which must be within the run. In the periodic regime all weights are 1: the
/// integral over one period, whatever the ends.
std::vector<double> window_weights(const TimeAxis& time, double from_s, double to_s,
                                   double edge_s = 0.0);

/// The time window of the `_period_` columns, or the reason why there is none.
struct PeriodWindow {
    double from_s = 0.0;
    double to_s = 0.0;
    double edge_s = 0.0; // the weight rises and falls in this time
    int periods = 0;     // number of whole modulation periods; 0: no modulation
    std::string reason;
    bool fits() const { return reason.empty(); }
};

/// Minimum number of frames per modulation period.
constexpr double fewest_frames_a_period = 4.0;

/// The largest whole number of modulation periods after `settled_after`, ending at `at`; without
/// modulation, the whole settled part. A reason if not even one period fits, if `at` is after the
/// end of the run, or if the frames are too far apart to resolve a period. Also a reason if the
/// load was switched off (off_s) more than a frame before the instant, since there is no focus
/// then. In the periodic regime the window is the period of the load. With PeriodWeight::sliding
/// the window is the settled part, and its weight the mean over all windows of one period in it: a
/// box of one period convolved with another box, which is a trapezoid. Like one period, it contains
/// no harmonic of the modulation, and it is a continuous function of the frequency.
PeriodWindow period_window(const MeasureOptions& measure, const TimeAxis& time,
                           std::optional<double> modulation_frequency_Hz,
                           double off_s = std::numeric_limits<double>::infinity());

/// The reason why there is no focus at the instant; empty if there is one.
std::string no_focus_reason(const MeasureOptions& measure, const TimeAxis& time, double off_s);

/// Sums for the `_period_` columns: numerators and denominators of the surface measures, each
/// summed over time with the weights of the window (window.hpp) BEFORE division. Angle brackets:
/// the weighted sum over frames.
struct PeriodSums {
    double u_squared = 0.0;     // < (sum u)^2 >
    double abs_u_squared = 0.0; // < (sum |u|)^2 >
    double u2 = 0.0;            // < sum u^2 >
    double u2_squared = 0.0;    // < (sum u^2)^2 >
    double u4 = 0.0;            // < sum u^4 >
    double focal_u2 = 0.0;      // < sum w u^2 >
    double focal_weight = 0.0;  // < sum w >
    double weight = 0.0;        // < 1 >, in frames
};

/// `weights` has one entry per frame; frames of weight 0 are ignored.
PeriodSums period_sums(std::span<const SurfaceSums> frames, std::span<const double> weights);

/// The fraction of the area of the focal discs that lies inside the measured region, averaged over
/// the frames with these weights. Not collective.
double focal_share(const Case& c, std::span<const SurfaceSums> frames,
                   std::span<const double> weights);

} // namespace shearwake::measures
