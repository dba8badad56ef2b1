// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/period.hpp"

#include "base/overloaded.hpp"
#include "problem/load/motion/course.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace shearwake {
namespace {

/// Deviation from a whole number of periods, in periods.
constexpr double commensurate = 1e-6;

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

void add_of(const Gain& gain, std::vector<double>& frequencies_Hz) {
    std::visit(overloaded{[&](const SineGain& sine) {
                              if (sine.depth > 0.0) frequencies_Hz.push_back(sine.frequency_Hz);
                          },
                          [&](const SquareGain& square) {
                              if (square.depth > 0.0) frequencies_Hz.push_back(square.frequency_Hz);
                          },
                          [&](const SampledGain& sampled) {
                              if (sampled.repeat)
                                  frequencies_Hz.push_back(1.0 / sampled.period_s());
                          },
                          [](const RampGain&) {}, [](const WindowGain&) {}},
               gain);
}

/// The reason why a gain does not repeat; empty if it does.
std::string why_not(const Gain& gain) {
    const std::string once = "rises or falls once (a ramp or a window), which a load that repeats "
                             "for ever cannot; remove it";
    return std::visit(
        overloaded{[&](const RampGain&) { return once; }, [&](const WindowGain&) { return once; },
                   [](const SineGain&) { return std::string(); },
                   [](const SquareGain&) { return std::string(); },
                   [](const SampledGain& sampled) {
                       return std::string(sampled.repeat ? ""
                                                         : "has an envelope of samples that are "
                                                           "not repeated; set repeat = true");
                   }},
        gain);
}

/// The reason why the load does not repeat; empty if it does.
std::string why_not(const Load& load) {
    for (const Mover& mover : load.modulation.trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&mover))
            if (travel->at_end == AtEnd::off || travel->at_end == AtEnd::hold)
                return "has a path that ends; set path.at_end = \"repeat\" or \"back-and-forth\"";
    for (const Gain& gain : load.modulation.envelope.gains)
        if (const std::string reason = why_not(gain); !reason.empty()) return reason;
    return {};
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

} // namespace

std::vector<double> frequencies_of(const Load& load) {
    std::vector<double> frequencies_Hz;
    for (const Mover& mover : load.modulation.trajectory.parts)
        add_of(mover, frequencies_Hz);
    const auto* array = std::get_if<ArrayFootprint>(&load.footprint);
    if (array && array->update_rate_Hz > 0.0 && !frequencies_Hz.empty())
        frequencies_Hz.push_back(array->update_rate_Hz);
    for (const Gain& gain : load.modulation.envelope.gains)
        add_of(gain, frequencies_Hz);
    if (const auto* carrier = std::get_if<ResolvedCarrier>(&load.carrier))
        frequencies_Hz.push_back(carrier->frequency_Hz);
    std::ranges::sort(frequencies_Hz);
    const auto same = std::unique(frequencies_Hz.begin(), frequencies_Hz.end());
    frequencies_Hz.erase(same, frequencies_Hz.end());
    return frequencies_Hz;
}

LoadPeriod least_period(const Load& load, double longest_s) {
    if (std::string reason = why_not(load); !reason.empty()) return {0.0, std::move(reason)};
    const std::vector<double> frequencies_Hz = frequencies_of(load);
    if (frequencies_Hz.empty())
        return {0.0, "is constant and therefore has no period; use time.regime = \"transient\""};
    for (double periods = 1.0; periods / frequencies_Hz.front() <= longest_s * (1.0 + 1e-9);
         ++periods) {
        const double period_s = periods / frequencies_Hz.front();
        if (std::ranges::all_of(frequencies_Hz, [&](double frequency_Hz) {
                const double count = frequency_Hz * period_s;
                return std::abs(count - std::round(count)) <= commensurate;
            }))
            return {period_s, ""};
    }
    return {0.0, fmt::format("has the {} {} Hz, which have no common period of up to {:g} ms; use "
                             "commensurate frequencies, or increase time.longest_period_ms",
                             frequencies_Hz.size() > 1 ? "frequencies" : "frequency",
                             listed(frequencies_Hz), 1e3 * longest_s)};
}

} // namespace shearwake
