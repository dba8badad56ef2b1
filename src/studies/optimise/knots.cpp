// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/forms.hpp"

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
    return {.count = static_cast<std::ptrdiff_t>(intervals) + (is_periodic(c) ? 0 : 1),
            .interval_s = until_s / intervals,
            .repeat = is_periodic(c)};
}

Case knot_case(const Case& c, const Knots& knots, std::ptrdiff_t knot) {
    std::vector<double> values(static_cast<std::size_t>(knots.count), 0.0);
    values.at(static_cast<std::size_t>(knot)) = 1.0;
    Case alone = c;
    alone.scene.load.modulation.envelope.gains = {SampledGain{
        .values = std::move(values), .interval_s = knots.interval_s, .repeat = knots.repeat}};
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

Case without_record(Case c) {
    c.measure.depths_m.resize(1);
    const Vec2 trace = trace_m(c);
    c.record = RecordOptions{};
    c.record.traces_m = {trace};
    c.afferents.reset();
    return c;
}

double window_s(const Case& c) {
    const Modulation& modulation = c.scene.load.modulation;
    const measures::PeriodWindow window = measures::period_window(
        c.measure, c.time, modulation_frequency_Hz(modulation), off_time_s(modulation.trajectory));
    return window.to_s - window.from_s;
}

namespace {

/// The reason why the case cannot be optimised; empty if it can.
std::string unsupported_reason(const Case& c, const OptimiseOptions& options) {
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
               "constant speed without rests";
    if (options.uniformity > 0.0 && samples_along_path(c).empty())
        return "optimise.uniformity requires a focus that moves along a path";
    return {};
}

/// In the periodic regime, the compared modulations must repeat with the period of the case.
void require_periods(const Case& c, const std::vector<double>& frequencies_Hz, const char* key) {
    if (!is_periodic(c)) return;
    for (const double frequency_Hz : frequencies_Hz) {
        const double periods = frequency_Hz * c.time.duration_s();
        if (std::abs(periods - std::round(periods)) > 1e-6)
            throw UsageError(fmt::format("optimise.{}: {:.8g} Hz has no whole number of periods in "
                                         "the period of the load, {:.8g} ms",
                                         key, frequency_Hz, 1e3 * c.time.duration_s()),
                             ExitCode::bad_job);
    }
}

/// A display must repeat a whole number of updates, and an envelope has a limited number.
void require_updates(const Knots& knots, double update_rate_Hz) {
    const double until_s =
        static_cast<double>(knots.repeat ? knots.count : knots.count - 1) * knots.interval_s;
    const double updates = until_s * update_rate_Hz, nearest = std::round(updates);
    const bool is_integer = std::abs(updates - nearest) <= 1e-9 * updates; // rounding
    if (knots.repeat && (!is_integer || nearest < 1.0))
        throw UsageError(
            fmt::format("optimise.update_rate_Hz = {:g} results in {:.6f} updates in the period of "
                        "{:.9g} ms; a display repeats a whole number of updates, so choose a rate "
                        "or a speed with a whole number",
                        update_rate_Hz, updates, 1e3 * until_s),
            ExitCode::bad_job);
    const double count = (is_integer ? nearest : std::ceil(updates)) + (knots.repeat ? 0.0 : 1.0);
    if (count > static_cast<double>(most_samples))
        throw UsageError(fmt::format("optimise.update_rate_Hz = {:g} results in {:.0f} updates, "
                                     "but an envelope may have at most {}; use a lower rate",
                                     update_rate_Hz, count, most_samples));
}

} // namespace

void require_optimisable(const Case& c, const std::string& id, const Knots& knots,
                         const OptimiseOptions& options) {
    if (const std::string reason = unsupported_reason(c, options); !reason.empty())
        throw UsageError(fmt::format("case {} cannot be optimised: {}", id, reason),
                         ExitCode::bad_job);
    require_periods(c, options.am_frequencies_Hz, "am_frequency_Hz");
    require_periods(c, options.sm_frequencies_Hz, "sm_frequency_Hz");
    if (options.update_rate_Hz > 0.0) require_updates(knots, options.update_rate_Hz);
}

} // namespace shearwake::optimise
