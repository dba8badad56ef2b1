// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/sensation_window.hpp"

#include "problem/load/load.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake {
namespace {

/// Relative, for the rounding of times.
constexpr double rounding = 1e-9;

/// Whether a gain that rises or falls once does not change in this time.
bool rests(const Gain& gain, double from_s, double to_s) {
    return std::visit(
        overloaded{[&](const RampGain& g) {
                       return g.start_s + g.duration_s <= from_s || g.start_s >= to_s;
                   },
                   [&](const WindowGain& g) {
                       return g.from_s + g.edge_s <= from_s && g.to_s - g.edge_s >= to_s;
                   },
                   [&](const SampledGain& g) { return g.period_s() - g.interval_s <= from_s; },
                   [](const auto&) { return false; }},
        gain);
}

/// The load without what does not change between two times: gains that rise or fall once, and paths
/// at whose end the focus rests already.
Load changing_load(Load load, double from_s, double to_s) {
    std::erase_if(load.modulation.envelope.gains,
                  [&](const Gain& gain) { return acts_once(gain) && rests(gain, from_s, to_s); });
    for (Mover& mover : load.modulation.trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&mover);
            travel && travel->at_end == AtEnd::hold && cycle_s(*travel) <= from_s)
            mover = Hold{};
    return load;
}

/// Why a Hann window of this duration has no level of a load that repeats.
std::string few_periods_reason(const Load& load, double duration_s) {
    const double slowest_Hz = frequencies_of(load).front();
    if (slowest_Hz * duration_s >= fewest_periods_in_window * (1.0 - rounding)) return {};
    const double longest_s = fewest_periods_in_window / slowest_Hz;
    const LoadPeriod period = least_period(load, longest_s);
    const bool is_gain = std::ranges::any_of(load.modulation.envelope.gains, [&](const Gain& g) {
        return repetition_Hz(g) == slowest_Hz;
    });
    return fmt::format("{} at {:.4g} Hz needs {:.4g} ms between measure.settled_after_ms and "
                       "measure.at_ms, which are {:.4g} ms apart",
                       is_gain ? "AM" : "the motion of the focus", slowest_Hz,
                       1e3 * (period.reason.empty() ? period.period_s : longest_s),
                       1e3 * duration_s);
}

} // namespace

SensationWindow sensation_window(const Case& c) {
    const TimeAxis& time = c.time;
    // The second difference at the last frame would need the one after it.
    SensationWindow window{.end_s = std::min(c.measure.at_s, time.duration_s() - time.interval_s)};
    const double settled_s = window.end_s - c.measure.settled_after_s + time.interval_s;
    if (!(settled_s > 4.0 * time.interval_s)) {
        window.reason = "fewer than four frames lie between measure.settled_after_ms and "
                        "measure.at_ms";
        return window;
    }
    const Load load = changing_load(c.scene().load, window.end_s - settled_s, window.end_s);
    const LoadPeriod period = least_period(load, settled_s);
    window.has_whole_periods = period.reason.empty();
    window.duration_s =
        window.has_whole_periods
            ? std::floor(settled_s / period.period_s * (1.0 + rounding)) * period.period_s
            : std::min(settled_s, window.end_s);
    if (window.has_whole_periods) return window;
    window.reason = aperiodicity_reason(load);
    if (!window.reason.empty())
        window.reason = "the load " + window.reason;
    else if (frequencies_of(load).empty())
        window.reason = "the load does not change between measure.settled_after_ms and "
                        "measure.at_ms";
    else
        window.reason = few_periods_reason(load, window.duration_s);
    return window;
}

} // namespace shearwake
