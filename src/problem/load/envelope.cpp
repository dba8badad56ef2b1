// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/envelope.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake {
namespace {

/// Rises from 0 at time 0 to 1 at `duration_s`.
double sin2_step(double since_s, double duration_s) {
    if (since_s >= duration_s) return 1.0;
    if (since_s <= 0.0) return 0.0;
    return std::pow(std::sin(0.25 * two_pi * since_s / duration_s), 2);
}

double gain_value(const SineGain& g, double t_s) {
    return 1.0 - 0.5 * g.depth * (1.0 + std::cos(two_pi * g.frequency_Hz * t_s + g.phase_rad));
}

double gain_value(const RampGain& g, double t_s) {
    return g.from + (g.to - g.from) * sin2_step(t_s - g.start_s, g.duration_s);
}

double gain_value(const SquareGain& g, double t_s) {
    const double periods = g.frequency_Hz * t_s + g.phase_rad / two_pi;
    const double since_rise_s = (periods - std::floor(periods)) / g.frequency_Hz;
    const double high_s = g.duty / g.frequency_Hz;
    const double up = since_rise_s < high_s ? sin2_step(since_rise_s, g.edge_s)
                                            : 1.0 - sin2_step(since_rise_s - high_s, g.edge_s);
    return 1.0 - g.depth * (1.0 - up);
}

double gain_value(const WindowGain& g, double t_s) {
    if (t_s < g.from_s || t_s > g.to_s) return 0.0;
    return std::min(sin2_step(t_s - g.from_s, g.edge_s), sin2_step(g.to_s - t_s, g.edge_s));
}

double gain_value(const SampledGain& g, double t_s) {
    const auto count = static_cast<std::ptrdiff_t>(g.values.size());
    if (count == 0) return 1.0;
    const auto value = [&](std::ptrdiff_t n) { return g.values[static_cast<std::size_t>(n)]; };
    double at = t_s / g.interval_s;
    if (g.repeat) {
        at -= std::floor(at / static_cast<double>(count)) * static_cast<double>(count);
    } else {
        if (at <= 0.0) return g.values.front();
        if (at >= static_cast<double>(count - 1)) return g.values.back();
    }
    const auto before = std::min(static_cast<std::ptrdiff_t>(at), count - 1);
    const double share = at - static_cast<double>(before);
    return (1.0 - share) * value(before) + share * value((before + 1) % count);
}

/// Before, within or after an interval.
double part_of(double t_s, double from_s, double to_s) {
    return t_s < from_s ? 0.0 : t_s < to_s ? 1.0 : 2.0;
}

double smooth_piece(const SineGain&, double) {
    return 0.0;
}
double smooth_piece(const RampGain& g, double t_s) {
    return part_of(t_s, g.start_s, g.start_s + g.duration_s);
}
double smooth_piece(const SquareGain& g, double t_s) {
    const double periods = g.frequency_Hz * t_s + g.phase_rad / two_pi;
    const double since_rise_s = (periods - std::floor(periods)) / g.frequency_Hz;
    const double high_s = g.duty / g.frequency_Hz;
    return 6.0 * std::floor(periods) + part_of(since_rise_s, 0.0, g.edge_s) +
           (since_rise_s < high_s ? 0.0 : part_of(since_rise_s, high_s, high_s + g.edge_s) + 2.0);
}
double smooth_piece(const WindowGain& g, double t_s) {
    return part_of(t_s, g.from_s, g.from_s + g.edge_s) +
           3.0 * part_of(t_s, g.to_s - g.edge_s, g.to_s);
}
double smooth_piece(const SampledGain& g, double t_s) {
    const double at = std::floor(t_s / g.interval_s), last = static_cast<double>(g.values.size());
    return g.repeat ? at : std::clamp(at, -1.0, last - 1.0);
}

/// The highest frequency of an edge of this duration; a jump has none and is ignored.
double edge_frequency_Hz(double edge_s) {
    return edge_s > 0.0 ? 2.0 / edge_s : 0.0;
}

double greatest_frequency_Hz(const SineGain& g) {
    return g.depth > 0.0 ? g.frequency_Hz : 0.0;
}
double greatest_frequency_Hz(const RampGain& g) {
    return edge_frequency_Hz(g.duration_s);
}
double greatest_frequency_Hz(const SquareGain& g) {
    return g.depth > 0.0 ? std::max(g.frequency_Hz, edge_frequency_Hz(g.edge_s)) : 0.0;
}
double greatest_frequency_Hz(const WindowGain& g) {
    return edge_frequency_Hz(g.edge_s);
}
/// The highest frequency that the samples represent.
double greatest_frequency_Hz(const SampledGain& g) {
    return g.interval_s > 0.0 ? 0.5 / g.interval_s : 0.0;
}

constexpr double rounding = 1e-12;

} // namespace

std::optional<GainConflict> SquareGain::complete() {
    // From the end of one edge to the next, at most half of the shorter part of a period.
    const double shorter_s = std::min(duty, 1.0 - duty) / frequency_Hz;
    if (edge_s == 0.0) edge_s = std::min(usual_edge_s, 0.5 * shorter_s);
    if (edge_s <= shorter_s * (1.0 + rounding)) return std::nullopt;
    return GainConflict{
        "edge_us",
        fmt::format("must be at most {:.6g}, the shorter part of a period, but is {:.6g}",
                    1e6 * shorter_s, 1e6 * edge_s)};
}

std::optional<GainConflict> WindowGain::complete() {
    const double lasts_s = to_s - from_s;
    if (edge_s == 0.0) edge_s = std::min(usual_edge_s, 0.5 * lasts_s);
    if (!(lasts_s > 0.0))
        return GainConflict{"to_ms", fmt::format("must be after from_ms = {:.6g}, but is {:.6g}",
                                                 1e3 * from_s, 1e3 * to_s)};
    if (2.0 * edge_s <= lasts_s * (1.0 + rounding)) return std::nullopt;
    return GainConflict{"edge_us",
                        fmt::format("must be at most {:.6g}, half of the window, but is {:.6g}",
                                    0.5e6 * lasts_s, 1e6 * edge_s)};
}

double gain(const Envelope& envelope, double t_s) {
    double product = 1.0;
    for (const Gain& factor : envelope.gains)
        product *= std::visit(
            [&](const auto& g) {
                const double value = gain_value(g, t_s);
                return g.on == GainOn::pressure ? value * value : value;
            },
            factor);
    return product;
}

void add_smooth_pieces(const Envelope& envelope, double t_s, std::vector<double>& numbers) {
    for (const Gain& factor : envelope.gains)
        numbers.push_back(std::visit([&](const auto& g) { return smooth_piece(g, t_s); }, factor));
}

double repetition_Hz(const Gain& gain) {
    const auto of_wave = [](const auto& g) { return g.depth != 0.0 ? g.frequency_Hz : 0.0; };
    return std::visit(
        overloaded{
            [&](const SineGain& g) { return of_wave(g); }, [](const RampGain&) { return 0.0; },
            [&](const SquareGain& g) { return of_wave(g); }, [](const WindowGain&) { return 0.0; },
            [](const SampledGain& g) { return g.repeat ? 1.0 / g.period_s() : 0.0; }},
        gain);
}

bool acts_once(const Gain& gain) {
    return std::visit(
        overloaded{[](const SineGain&) { return false; }, [](const RampGain&) { return true; },
                   [](const SquareGain&) { return false; }, [](const WindowGain&) { return true; },
                   [](const SampledGain& g) { return !g.repeat; }},
        gain);
}

bool rests(const Gain& gain, double from_s, double to_s) {
    return std::visit(overloaded{[](const SineGain&) { return false; },
                                 [&](const RampGain& g) {
                                     return g.start_s + g.duration_s <= from_s || g.start_s >= to_s;
                                 },
                                 [](const SquareGain&) { return false; },
                                 [&](const WindowGain& g) {
                                     return (g.from_s + g.edge_s <= from_s &&
                                             g.to_s - g.edge_s >= to_s) ||
                                            g.to_s <= from_s || g.from_s >= to_s;
                                 },
                                 [&](const SampledGain& g) {
                                     return !g.repeat && g.period_s() - g.interval_s <= from_s;
                                 }},
                      gain);
}

bool is_smooth(const Gain& gain) {
    return std::holds_alternative<SineGain>(gain);
}

Edge edge_of(const Gain& gain) {
    return std::visit(overloaded{[](const SineGain&) { return Edge{}; },
                                 [](const RampGain& g) {
                                     return Edge{g.duration_s, std::abs(g.to - g.from)};
                                 },
                                 [](const SquareGain& g) {
                                     return Edge{g.edge_s, g.depth};
                                 },
                                 [](const WindowGain& g) { return Edge{g.edge_s}; },
                                 [](const SampledGain& g) { return Edge{g.interval_s}; }},
                      gain);
}

double largest(const Gain& gain, double end_s) {
    return std::visit(overloaded{[](const SineGain&) { return 1.0; },
                                 [&](const RampGain& g) {
                                     return std::max(g.from, shearwake::gain({{g}}, end_s));
                                 },
                                 [](const SquareGain&) { return 1.0; },
                                 [&](const WindowGain& g) { return g.from_s < end_s ? 1.0 : 0.0; },
                                 [](const SampledGain&) { return 1.0; }},
                      gain);
}

double gain_frequency_Hz(const Envelope& envelope) {
    for (const Gain& factor : envelope.gains)
        if (const double frequency_Hz = repetition_Hz(factor); frequency_Hz > 0.0)
            return frequency_Hz;
    return 0.0;
}

double greatest_envelope_frequency_Hz(const Envelope& envelope) {
    double sum = 0.0;
    for (const Gain& factor : envelope.gains)
        sum += std::visit(
            [](const auto& g) {
                return (g.on == GainOn::pressure ? 2.0 : 1.0) * greatest_frequency_Hz(g);
            },
            factor);
    return sum;
}

} // namespace shearwake
