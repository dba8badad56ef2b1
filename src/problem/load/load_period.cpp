// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/load.hpp"

#include "base/units.hpp"
#include "problem/load/motion/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

// The period of a load, declared in load.hpp.

namespace shearwake {
namespace {

/// Deviation from a whole number of periods, in periods.
constexpr double commensurate = 1e-6;
/// Largest number of periods of the lowest frequency that are tried as a common period.
constexpr double most_periods = 1e6;

void add_of(const Mover& mover, std::vector<double>& frequencies_Hz) {
    std::visit(overloaded{[](const Hold&) {},
                          [&](const Swing& swing) {
                              if (norm(swing.amplitude_m) > 0.0)
                                  frequencies_Hz.push_back(swing.frequency_Hz);
                          },
                          [&](const Travel& travel) {
                              const auto* speed = std::get_if<OscillatingSpeed>(&travel.motion);
                              if (!speed) {
                                  frequencies_Hz.push_back(1.0 / cycle_s(travel));
                                  return;
                              }
                              frequencies_Hz.push_back(speed->mean_m_s / cycle_m(travel));
                              if (speed->deviation_m_s != 0.0)
                                  frequencies_Hz.push_back(speed->frequency_Hz);
                          }},
               mover);
}

std::string listed(const std::vector<double>& frequencies_Hz) {
    std::string text;
    for (std::size_t i = 0; i < frequencies_Hz.size(); ++i)
        text += fmt::format("{}{:.8g}",
                            i == 0                           ? ""
                            : i + 1 == frequencies_Hz.size() ? " and "
                                                             : ", ",
                            frequencies_Hz[i]);
    return text;
}

/// The frequency nearest to one of a pair that has a common period with the other: that of the
/// shortest period up to `longest_s` for which it changes by at most 1 %, or else the nearest one.
struct Commensurate {
    double frequency_Hz = 0.0, period_s = 0.0; // 0: there is none
};
Commensurate commensurate_with(double other_Hz, double frequency_Hz, double longest_s) {
    constexpr double small = 0.01;
    Commensurate nearest;
    const double most = std::min(longest_s * (1.0 + 1e-9) * other_Hz, most_periods);
    for (double periods = 1.0; periods <= most; ++periods) {
        const double period_s = periods / other_Hz,
                     found_Hz = std::max(1.0, std::round(frequency_Hz * period_s)) / period_s;
        if (nearest.period_s == 0.0 ||
            std::abs(found_Hz - frequency_Hz) < std::abs(nearest.frequency_Hz - frequency_Hz))
            nearest = {found_Hz, period_s};
        if (std::abs(nearest.frequency_Hz - frequency_Hz) <= small * frequency_Hz) break;
    }
    return nearest;
}

/// The constant or mean speed of the path that repeats with this frequency; 0 if there is none.
double speed_of_cycle_m_s(const Load& load, double frequency_Hz) {
    for (const Mover& mover : load.modulation.trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&mover)) {
            const double speed_m_s = frequency_Hz * cycle_m(*travel);
            const auto is_speed = [&](double given_m_s) {
                return std::abs(speed_m_s - given_m_s) <= commensurate * given_m_s;
            };
            if (const auto* constant = std::get_if<ConstantSpeed>(&travel->motion);
                constant && is_speed(constant->speed_m_s))
                return speed_m_s;
            if (const auto* oscillates = std::get_if<OscillatingSpeed>(&travel->motion);
                oscillates && is_speed(oscillates->mean_m_s))
                return speed_m_s;
        }
    return 0.0;
}

/// ", for example ...": what gives two frequencies a common period; empty for more of them.
std::string usable_values(const Load& load, const std::vector<double>& frequencies_Hz,
                          double longest_s) {
    if (frequencies_Hz.size() != 2) return {};
    std::string text;
    for (const std::size_t i : {0u, 1u}) {
        const double given_Hz = frequencies_Hz[i];
        const Commensurate usable = commensurate_with(frequencies_Hz[1 - i], given_Hz, longest_s);
        if (usable.period_s == 0.0) continue;
        const double speed_m_s = speed_of_cycle_m_s(load, given_Hz);
        const double unit = speed_m_s > 0.0 ? speed_m_s / given_Hz : 1.0;
        text += fmt::format("{}{:.10g} {} instead of {:.8g} (period {:.4g} ms)",
                            text.empty() ? ", for example " : " or ", unit * usable.frequency_Hz,
                            speed_m_s > 0.0 ? "m/s" : "Hz", unit * given_Hz, 1e3 * usable.period_s);
    }
    return text;
}

} // namespace

std::string aperiodicity_reason(const Load& load) {
    for (const Mover& mover : load.modulation.trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&mover))
            if (travel->at_end == AtEnd::off || travel->at_end == AtEnd::hold)
                return "has a path that ends; set path.at_end = \"repeat\" or \"back-and-forth\"";
    if (std::ranges::any_of(load.modulation.envelope.gains, acts_once))
        return "rises or falls once (a ramp, a window, or samples that are not repeated), which a "
               "load that repeats for ever cannot; remove it, or set repeat = true";
    return {};
}

std::vector<double> frequencies_of(const Load& load) {
    std::vector<double> frequencies_Hz;
    for (const Mover& mover : load.modulation.trajectory.parts)
        add_of(mover, frequencies_Hz);
    if (const double rate_Hz = update_rate_Hz(load.footprint);
        rate_Hz > 0.0 && !frequencies_Hz.empty())
        frequencies_Hz.push_back(rate_Hz);
    for (const Gain& gain : load.modulation.envelope.gains)
        if (const double gain_Hz = repetition_Hz(gain); gain_Hz > 0.0)
            frequencies_Hz.push_back(gain_Hz);
    if (const double carrier_Hz = carrier_frequency_Hz(load.carrier); carrier_Hz > 0.0)
        frequencies_Hz.push_back(carrier_Hz);
    std::ranges::sort(frequencies_Hz);
    const auto same = std::unique(frequencies_Hz.begin(), frequencies_Hz.end());
    frequencies_Hz.erase(same, frequencies_Hz.end());
    return frequencies_Hz;
}

LoadPeriod least_period(const Load& load, double longest_s) {
    if (std::string reason = aperiodicity_reason(load); !reason.empty())
        return {0.0, std::move(reason)};
    const std::vector<double> frequencies_Hz = frequencies_of(load);
    if (frequencies_Hz.empty())
        return {0.0, "is constant and therefore has no period; use time.regime = \"transient\""};
    const double most = longest_s * (1.0 + 1e-9) * frequencies_Hz.front();
    for (double periods = 1.0; periods <= std::min(most, most_periods); ++periods) {
        const double period_s = periods / frequencies_Hz.front();
        if (std::ranges::all_of(frequencies_Hz, [&](double frequency_Hz) {
                const double count = frequency_Hz * period_s;
                return std::abs(count - std::round(count)) <= commensurate;
            }))
            return {period_s, ""};
    }
    if (most > most_periods)
        return {0.0, fmt::format("has the lowest frequency {:.8g} Hz and no common period of up to "
                                 "{:.0f} of its periods, the largest number that is supported; use "
                                 "commensurate or lower frequencies",
                                 frequencies_Hz.front(), most_periods)};
    return {0.0, fmt::format("has the {} {} Hz, which have no common period of up to {:g} ms; use "
                             "commensurate frequencies{}, or increase time.longest_period_ms",
                             frequencies_Hz.size() > 1 ? "frequencies" : "frequency",
                             listed(frequencies_Hz), 1e3 * longest_s,
                             usable_values(load, frequencies_Hz, longest_s))};
}

} // namespace shearwake
