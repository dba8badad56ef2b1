// SPDX-License-Identifier: BSD-3-Clause
#include "measures/window.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace shearwake::measures {

namespace {

/// Shorter edges, in units of the interval, are considered vertical.
constexpr double shortest_edge = 1e-6;

/// The integral of max(0, t - from) times the hat function of a frame at t = 0, which is 1 there
/// and 0 at the frames -1 and 1.
double ramp_of_hat(double from) {
    if (from >= 1.0) return 0.0;
    if (from <= -1.0) return -from;
    const auto cube = [](double x) { return x > 0.0 ? x * x * x : 0.0; };
    return (cube(1.0 - from) - 2.0 * cube(-from)) / 6.0;
}

/// The weights of a trapezoid; all times in units of the interval.
void add_trapezoid(double from, double to, double edge, std::vector<double>& weights) {
    for (std::size_t n = 0; n < weights.size(); ++n) {
        const double at = static_cast<double>(n) + 1.0;
        if (at <= from - 1.0 || at >= to + 1.0) continue;
        weights[n] = (ramp_of_hat(from - at) - ramp_of_hat(from + edge - at) -
                      ramp_of_hat(to - edge - at) + ramp_of_hat(to - at)) /
                     edge;
    }
}

} // namespace

std::vector<double> window_weights(const TimeAxis& time, double from_s, double to_s,
                                   double edge_s) {
    // The trapezoidal rule over one period, in which the first frame follows the last one.
    if (time.regime == Regime::periodic)
        return std::vector<double>(static_cast<std::size_t>(time.frames), 1.0);
    std::vector<double> weights(static_cast<std::size_t>(time.frames), 0.0);
    // In units of the interval: frame n is at n + 1, and nothing has moved at 0.
    const double from = from_s / time.interval_s, to = to_s / time.interval_s;
    if (edge_s > shortest_edge * time.interval_s) {
        add_trapezoid(from, to, edge_s / time.interval_s, weights);
        return weights;
    }
    for (std::size_t n = 0; n < weights.size(); ++n) {
        const double left = static_cast<double>(n); // segment [n, n + 1] ends at frame n
        const double a = std::clamp(from - left, 0.0, 1.0);
        const double b = std::clamp(to - left, 0.0, 1.0);
        if (!(b > a)) continue;
        // f = (1 - s) f_left + s f_right, s from a to b.
        const double right_part = 0.5 * (b - a) * (b + a);
        weights[n] += right_part;
        if (n > 0) weights[n - 1] += (b - a) - right_part;
    }
    return weights;
}

std::string no_focus_reason(const MeasureOptions& measure, const TimeAxis& time, double off_s) {
    if (measure.at_s <= off_s + time.interval_s) return {};
    return fmt::format("the path ends at {:.4g} ms: there is no load at the instant, {:g} ms",
                       off_s * 1e3, measure.at_s * 1e3);
}

PeriodWindow period_window(const MeasureOptions& measure, const TimeAxis& time,
                           std::optional<double> modulation_frequency_Hz, double off_s) {
    // A relative tolerance of 1e-9, so that 280 frames of 50 us are 14 ms and contain ten whole
    // periods of 1.4 ms.
    constexpr double slack = 1e-9;
    const double at = measure.at_s, settled = measure.settled_after_s;
    if (time.regime == Regime::periodic)
        return {.from_s = 0.0,
                .to_s = time.duration_s(),
                .periods = static_cast<int>(
                    std::lround(modulation_frequency_Hz.value_or(0.0) * time.duration_s()))};
    PeriodWindow window{.from_s = settled, .to_s = at};
    if (at > time.duration_s() * (1.0 + slack)) {
        window.reason = fmt::format("the instant, {:g} ms, is after the end of the run at {:g} ms",
                                    at * 1e3, time.duration_s() * 1e3);
        return window;
    }
    if (!(at > settled)) {
        window.reason = fmt::format("the period window is empty: measure.at_ms, {:g} ms, is not "
                                    "after measure.settled_after_ms, {:g} ms",
                                    at * 1e3, settled * 1e3);
        return window;
    }
    window.reason = no_focus_reason(measure, time, off_s);
    if (!window.fits() || !modulation_frequency_Hz) return window;

    const double frequency = *modulation_frequency_Hz;
    const double periods = std::floor((at - settled) * frequency * (1.0 + slack));
    if (!(periods >= 1.0)) {
        window.reason = fmt::format(
            "a period of {:g} Hz takes {:.3g} ms and does not fit between {:g} and {:g} ms",
            frequency, 1e3 / frequency, settled * 1e3, at * 1e3);
        return window;
    }
    if (frequency * time.interval_s * fewest_frames_a_period > 1.0 + slack) {
        window.reason = fmt::format("frames every {:g} us cannot resolve a period of {:.3g} us",
                                    time.interval_s * 1e6, 1e6 / frequency);
        return window;
    }
    window.periods = static_cast<int>(periods);
    if (measure.window == PeriodWeight::sliding) {
        window.edge_s = std::min(1.0 / frequency, std::max(0.0, at - settled - 1.0 / frequency));
        return window;
    }
    window.from_s = std::max(settled, at - periods / frequency);
    return window;
}

PeriodSums period_sums(std::span<const SurfaceSums> frames, std::span<const double> weights) {
    assert(frames.size() == weights.size());
    PeriodSums sums;
    for (std::size_t n = 0; n < frames.size(); ++n) {
        const double weight = weights[n];
        if (weight == 0.0) continue;
        const SurfaceSums& frame = frames[n];
        sums.u_squared += weight * frame.u * frame.u;
        sums.abs_u_squared += weight * frame.abs_u * frame.abs_u;
        sums.u2 += weight * frame.u2;
        sums.u2_squared += weight * frame.u2 * frame.u2;
        sums.u4 += weight * frame.u4;
        sums.focal_u2 += weight * frame.focal_u2;
        sums.focal_weight += weight * frame.focal_weight;
        sums.weight += weight;
    }
    return sums;
}

double focal_share(const Case& c, std::span<const SurfaceSums> frames,
                   std::span<const double> weights) {
    const Region region = measured_region(c.domain, c.measure);
    const double radius_m = c.measure.focal_radius_m,
                 disc_cells = std::numbers::pi * std::pow(radius_m / c.domain.spacing_m, 2);
    double inside = 0.0, all = 0.0;
    for (std::size_t n = 0; n < frames.size(); ++n) {
        if (weights[n] == 0.0) continue;
        const std::vector<Vec2> places =
            foci(c.scene.load.modulation, c.time.frame_s(static_cast<std::ptrdiff_t>(n)));
        const double complete = disc_cells * static_cast<double>(places.size());
        double cells = frames[n].focal_weight;
        if (places.size() > 1 && cells < (1.0 - 1e-9) * complete) { // discs that overlap, too
            cells = 0.0;
            for (const Vec2& place : places) {
                const FocalRegion disc(c.domain, region, std::span(&place, 1), radius_m);
                for (std::ptrdiff_t i = disc.x_first; i < disc.x_end; ++i)
                    disc.row(i, [&](std::ptrdiff_t, double w) { cells += w; });
            }
        }
        inside += weights[n] * cells;
        all += weights[n] * complete;
    }
    return inside / all;
}

} // namespace shearwake::measures
