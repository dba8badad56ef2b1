// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/load/time_step.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "engines/layered/load/break_error.hpp"
#include "problem/case/edges.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <numbers>

namespace shearwake::layered {
namespace {

/// No shorter step is chosen. It resolves 40 kHz.
constexpr double shortest_step_s = 5e-6;

/// A step is at most this part of the time in which a shear wave crosses a standard deviation of
/// the footprint, if the load has breaks: H resonates at higher frequencies for the wavenumbers of
/// the footprint, and is not yet a sum of powers there, which BreakError underestimates.
constexpr double longest_share_of_crossing = 0.35;

/// The highest frequency of sinusoidal gains.
double sine_frequency_Hz(const Envelope& envelope) {
    Envelope sines;
    std::ranges::copy_if(envelope.gains, std::back_inserter(sines.gains),
                         [](const Gain& gain) { return std::holds_alternative<SineGain>(gain); });
    return greatest_envelope_frequency_Hz(sines);
}

/// A sinusoidal gain needs four times the samples of its frequency: it begins with a break, and
/// JumpTail requires the derivatives there to decrease.
double band_Hz(const Load& load) {
    double carrier = 0.0;
    if (const auto* resolved = std::get_if<ResolvedCarrier>(&load.carrier))
        carrier = resolved->frequency_Hz;
    const double scan = bandwidth_rad_m(load.footprint, band_fraction) *
                        greatest_speed_m_s(load.modulation.trajectory) / two_pi;
    // A focus that is updated at the rate of the array moves in jumps, which have content slightly
    // above that rate.
    const auto* array = std::get_if<ArrayFootprint>(&load.footprint);
    const double update = array && scan > 0.0 ? array->update_rate_Hz : 0.0;
    return std::max(scan + greatest_envelope_frequency_Hz(load.modulation.envelope) + carrier +
                        update,
                    4.0 * sine_frequency_Hz(load.modulation.envelope));
}

/// The longest step that resolves the load, or the step that the options specify.
double longest_step_s(const Case& c, const LayeredOptions& options) {
    if (options.time_step_s) return *options.time_step_s;
    return 1.0 / (2.5 * std::max(band_Hz(c.scene().load), 1.0));
}

/// Of a Gaussian of the same width.
double standard_deviation_m(const Load& load) {
    return fwhm_m(load.footprint) / (2.0 * std::sqrt(2.0 * std::log(2.0)));
}

/// The error at frames within four steps before and after a break counts, hence also that of a
/// break at the last frame, such as the end of a path, or shortly after it.
BreakError break_error(const Case& c, double cell_s) {
    const bool is_periodic = c.time.regime == Regime::periodic;
    const double from_s = is_periodic ? c.time.interval_s : 0.0;
    const double after_s = is_periodic ? 0.0 : 4.0 * cell_s;
    return {c, breaks_of(c.scene().load, from_s, from_s + c.time.duration_s() + after_s, cell_s),
            cell_s};
}

/// The number of samples per frame, from `least` on, for which BreakError is small enough.
std::ptrdiff_t samples_for_breaks(const Case& c, std::ptrdiff_t least) {
    const double sigma_m = standard_deviation_m(c.scene().load);
    const double longest_s =
        longest_share_of_crossing * sigma_m / edge_speed_m_s(c.scene().medium, sigma_m);
    auto count = std::max(least, static_cast<std::ptrdiff_t>(
                                     std::ceil(c.time.interval_s / longest_s * (1.0 - 1e-9))));
    // Finding the breaks takes as long as there are cells in the run.
    if (count == least && c.time.interval_s <= shortest_step_s * static_cast<double>(count))
        return least;
    const BreakError error = break_error(c, c.time.interval_s / static_cast<double>(least));
    if (error.relative(c.time.interval_s) == 0.0) return least;
    while (c.time.interval_s > shortest_step_s * static_cast<double>(count) &&
           error.relative(c.time.interval_s / static_cast<double>(count)) > step_accuracy)
        count += std::max<std::ptrdiff_t>(1, count / 4);
    return count;
}

} // namespace

double least_samples(const Case& c, const LayeredOptions& options) {
    const double window = c.time.regime == Regime::periodic ? 1.0 : options.window_factor;
    return window * static_cast<double>(c.time.frames) *
           std::max(1.0, c.time.interval_s / longest_step_s(c, options));
}

TimeTransform time_transform(const Case& c, const LayeredOptions& options) {
    const double ratio = c.time.interval_s / longest_step_s(c, options);
    auto per_frame =
        std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(std::ceil(ratio - 1e-9)));
    if (!options.time_step_s) per_frame = std::max(per_frame, samples_for_breaks(c, per_frame));
    const double window = c.time.regime == Regime::periodic ? 1.0 : options.window_factor;
    const double samples =
        window * static_cast<double>(c.time.frames) * static_cast<double>(per_frame);
    if (!options.time_step_s && samples > most_samples)
        throw UsageError(
            fmt::format("the jumps and kinks of the load require {:.3g} samples in time, {} per "
                        "frame, but at most {:.0e} are supported: use a shorter run, smooth gains "
                        "or solver.layered.time_step_us",
                        samples, per_frame, most_samples),
            ExitCode::bad_job);
    TimeTransform time;
    if (c.time.regime == Regime::periodic) {
        time.samples = c.time.frames * per_frame;
        time.step_s = c.time.interval_s / static_cast<double>(per_frame);
        time.first_s = c.time.interval_s;
        return time;
    }
    const std::ptrdiff_t coarse = good_even_length(static_cast<std::ptrdiff_t>(
        std::ceil(options.window_factor * static_cast<double>(c.time.frames))));
    time.samples = coarse * per_frame;
    time.step_s = c.time.interval_s / static_cast<double>(per_frame);
    time.decay_rad_s =
        std::log(options.wrap_suppression) / (static_cast<double>(time.samples) * time.step_s);
    return time;
}

double step_error(const Case& c, double step_s) {
    const Load& load = c.scene().load;
    const double resolved_rad_s = 0.8 * std::numbers::pi / step_s;
    const double speed_m_s = greatest_speed_m_s(load.modulation.trajectory);
    const double sigma_m = standard_deviation_m(load);
    double unresolved = 0.0;
    if (speed_m_s > 0.0)
        unresolved = std::erfc(resolved_rad_s * sigma_m / (std::sqrt(2.0) * speed_m_s));
    if (two_pi * greatest_envelope_frequency_Hz(load.modulation.envelope) > resolved_rad_s)
        unresolved = 1.0;
    return unresolved + break_error(c, step_s).relative(step_s);
}

std::ptrdiff_t samples_per_frame(const Case& c, const TimeTransform& time) {
    return static_cast<std::ptrdiff_t>(std::llround(c.time.interval_s / time.step_s));
}

} // namespace shearwake::layered
