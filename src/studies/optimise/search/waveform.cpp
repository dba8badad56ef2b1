// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/search/search.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "measures/window.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::optimise {

namespace {

bool is_periodic(const Case& c) {
    return c.time.regime == Regime::periodic;
}

} // namespace

Knots knots_of(const Case& c, double interval_s) {
    const double until_s = is_periodic(c) ? c.time.duration_s() : c.measure.at_s;
    const double intervals = std::max(2.0, std::round(until_s / interval_s));
    // Without repetition there is one more knot than intervals.
    return {.count = static_cast<Eigen::Index>(intervals) + (is_periodic(c) ? 0 : 1),
            .interval_s = until_s / intervals,
            .repeat = is_periodic(c)};
}

std::string why_not(const Case& c, const OptimiseOptions& options) {
    const Modulation& modulation = c.scene.load.modulation;
    if (!modulation.envelope.gains.empty())
        return fmt::format("the modulation {} has an envelope, which would be replaced; use a kind "
                           "without AM, for example STM, and no ramp",
                           modulation.kind);
    const measures::PeriodWindow window = measures::period_window(
        c.measure, c.time, modulation_frequency_Hz(modulation), off_time_s(modulation.trajectory));
    if (!window.fits()) return window.reason;
    if (!find_quotient(c, options.maximise))
        return fmt::format("optimise.maximise must be {}, but is \"{}\"; shares of energy need "
                           "measure.bands_Hz",
                           quoted_list(quotients_of(c)), options.maximise);
    if (options.over.size() > 1 && !has_speed(c))
        return "optimise.over has more than \"envelope\", but no focus moves along a path at "
               "constant "
               "speed without rests";
    if (options.uniformity > 0.0 && samples_along_path(c).empty())
        return "optimise.uniformity requires a focus that moves along a path";
    return {};
}

Case with_envelope(Case c, const Knots& knots, const Eigen::VectorXd& values) {
    c.scene.load.modulation.envelope.gains = {SampledGain{.values = {values.begin(), values.end()},
                                                          .interval_s = knots.interval_s,
                                                          .repeat = knots.repeat}};
    return c;
}

Case knot_case(const Case& c, const Knots& knots, Eigen::Index knot) {
    Case alone = with_envelope(c, knots, Eigen::VectorXd::Unit(knots.count, knot));
    alone.measure.depths_m.resize(1);
    alone.measure.bands.clear();
    alone.record = {.traces_m = {trace_m(c)},
                    .snapshots_s = {},
                    .frames = true,
                    .volumes_s = {},
                    .volume_fields = {}};
    alone.afferents.reset();
    return alone;
}

double window_s(const Case& c) {
    const Modulation& modulation = c.scene.load.modulation;
    const measures::PeriodWindow window = measures::period_window(
        c.measure, c.time, modulation_frequency_Hz(modulation), off_time_s(modulation.trajectory));
    return window.to_s - window.from_s;
}

Waveform waveform_of(const Knots& knots, const Eigen::VectorXd& values, double update_rate_Hz,
                     int bits) {
    const SampledGain linear{.values = {values.begin(), values.end()},
                             .interval_s = knots.interval_s,
                             .repeat = knots.repeat};
    const double until_s = knots.repeat ? linear.period_s() : knots.at_s(knots.count - 1);
    const double exact_updates = until_s * update_rate_Hz, nearest = std::round(exact_updates);
    const bool is_integer = std::abs(exact_updates - nearest) <= 1e-9 * exact_updates; // rounding
    if (knots.repeat && (!is_integer || nearest < 1.0))
        throw UsageError(
            fmt::format("optimise.update_rate_Hz = {:g} results in {:.6f} updates in the period of "
                        "{:.9g} ms; a display repeats a whole number of updates, so choose a rate "
                        "or a speed with a whole number",
                        update_rate_Hz, exact_updates, 1e3 * until_s),
            ExitCode::bad_job);
    const double updates = is_integer ? nearest : std::ceil(exact_updates);
    const double count = updates + (knots.repeat ? 0.0 : 1.0);
    if (count > static_cast<double>(most_samples))
        throw UsageError(fmt::format("optimise.update_rate_Hz = {:g} results in {:.0f} updates, "
                                     "but an envelope may have at most {}; use a lower rate",
                                     update_rate_Hz, count, most_samples));
    Waveform waveform{.interval_s = 1.0 / update_rate_Hz, .bits = bits, .repeat = knots.repeat};
    for (double n = 0.0; n < count; ++n) {
        const double force = gain({{linear}}, n * waveform.interval_s);
        waveform.levels.push_back(
            static_cast<int>(std::lround(std::sqrt(force) * waveform.greatest_level())));
    }
    return waveform;
}

SampledGain gain_of(const Waveform& waveform) {
    SampledGain sampled{.values = {}, .interval_s = waveform.interval_s, .repeat = waveform.repeat};
    for (const int level : waveform.levels) {
        const double pressure = static_cast<double>(level) / waveform.greatest_level();
        sampled.values.push_back(pressure * pressure);
    }
    return sampled;
}

std::string csv_text(const Waveform& waveform, const Trajectory& trajectory) {
    std::string text = "t_us,x_mm,y_mm,level,pressure_1,force_1\n";
    const SampledGain force = gain_of(waveform);
    for (std::size_t n = 0; n < waveform.levels.size(); ++n) {
        const double t_s = waveform.interval_s * static_cast<double>(n);
        const Vec2 at = position(trajectory, t_s);
        text += fmt::format("{:.9g},{:.9g},{:.9g},{},{:.9g},{:.9g}\n", 1e6 * t_s, 1e3 * at.x,
                            1e3 * at.y, waveform.levels[n], std::sqrt(force.values[n]),
                            force.values[n]);
    }
    return text;
}

std::string toml_text(const Waveform& waveform) {
    std::string text = "[[load.modulation.envelope]]\nshape = \"samples\"\n";
    text += fmt::format("interval_us = {}\n", exact(1e6 * waveform.interval_s));
    if (waveform.repeat) text += "repeat = true\n";
    text += "values = [";
    for (const double force : gain_of(waveform).values)
        text += (text.ends_with('[') ? "" : ", ") + exact(force);
    return text + "]\n";
}

} // namespace shearwake::optimise
