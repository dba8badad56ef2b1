// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/search/knots.hpp"

#include "base/text.hpp"
#include "measures/window.hpp"
#include "studies/optimise/search/quotient.hpp"
#include "studies/optimise/search/variation.hpp"

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
    if (c.study()) return "a k-Wave study has sources of its own, which have no envelope";
    const Modulation& modulation = c.scene().load.modulation;
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
    return {};
}

Case with_envelope(Case c, const Knots& knots, const Eigen::VectorXd& values) {
    c.scene().load.modulation.envelope.gains = {
        SampledGain{.values = {values.begin(), values.end()},
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
    const Modulation& modulation = c.scene().load.modulation;
    const measures::PeriodWindow window = measures::period_window(
        c.measure, c.time, modulation_frequency_Hz(modulation), off_time_s(modulation.trajectory));
    return window.to_s - window.from_s;
}

} // namespace shearwake::optimise
