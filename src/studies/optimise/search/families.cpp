// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/search/families.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::optimise {
namespace {

constexpr int depths = 20, phases = 24; // of the grid of AM-STM
constexpr double fewest_knots_a_period = 6.0;
constexpr int most_sm_periods = 5;
constexpr double first_deviation = 0.45, deviation_step = 0.15; // of SM-STM, relative to the speed

double drive(const AmEnvelope& am, double t_s) {
    return 1.0 - 0.5 * am.depth * (1.0 + std::cos(two_pi * am.frequency_Hz * t_s + am.phase_rad));
}

/// Adds an SM-STM that can be computed.
void add_sm(std::vector<SmCase>& cases, const Case& c, double frequency_Hz, double deviation_m_s,
            double phase_rad) {
    SmCase sm{frequency_Hz, deviation_m_s, phase_rad,
              with_oscillating_speed(c, frequency_Hz, deviation_m_s, phase_rad)};
    if (can_be_computed(sm.physics)) cases.push_back(std::move(sm));
}

} // namespace

std::vector<double> am_frequencies_Hz(const Case& c, const Knots& knots,
                                      const OptimiseOptions& options) {
    if (!options.am_frequencies_Hz.empty()) return options.am_frequencies_Hz;
    std::vector<double> frequencies_Hz;
    const double lowest_Hz = 1.0 / window_s(c);
    for (double periods = 1.0;
         periods * lowest_Hz * knots.interval_s * fewest_knots_a_period <= 1.0 + 1e-9; ++periods)
        frequencies_Hz.push_back(periods * lowest_Hz);
    return frequencies_Hz;
}

AmEnvelope best_am(const Forms& forms, const Knots& knots, const Required& required,
                   const std::vector<double>& frequencies_Hz) {
    AmEnvelope best{.envelope = unmodulated(forms)};
    if (!required.is_met_by(forms, best.envelope.values)) best.envelope.eta = 0.0;
    for (const double frequency_Hz : frequencies_Hz)
        for (int d = 1; d <= depths; ++d)
            for (int p = 0; p < phases; ++p) {
                AmEnvelope am{.frequency_Hz = frequency_Hz,
                              .depth = static_cast<double>(d) / depths,
                              .phase_rad = two_pi * p / phases};
                Eigen::VectorXd values(knots.count);
                for (Eigen::Index j = 0; j < knots.count; ++j)
                    values(j) = drive(am, knots.at_s(j));
                am.envelope = measured(forms, values);
                if (am.envelope.eta > best.envelope.eta && required.is_met_by(forms, values))
                    best = std::move(am);
            }
    return best;
}

std::optional<MotionChange> motion_of(const SmCase& sm, const Case& c) {
    const double periods = sm.frequency_Hz * window_s(c);
    if (std::abs(periods - std::round(periods)) > 1e-6) return std::nullopt;
    const double deviation = sm.deviation_m_s / speed_m_s(c);
    return MotionChange{.periods = static_cast<int>(std::lround(periods)),
                        .sine = deviation * std::cos(sm.phase_rad),
                        .cosine = deviation * std::sin(sm.phase_rad)};
}

std::vector<SmCase> sm_cases(const Case& c, const OptimiseOptions& options) {
    if (!has_speed(c)) return {};
    std::vector<double> frequencies_Hz = options.sm_frequencies_Hz,
                        deviations_m_s = options.sm_deviations_m_s;
    if (frequencies_Hz.empty())
        for (int periods = 1; periods <= most_sm_periods; ++periods)
            frequencies_Hz.push_back(periods / window_s(c));
    if (deviations_m_s.empty()) deviations_m_s = {first_deviation * speed_m_s(c)};
    std::vector<SmCase> cases;
    for (const double frequency_Hz : frequencies_Hz)
        for (const double deviation_m_s : deviations_m_s)
            for (int quarter = 0; quarter < 4; ++quarter)
                add_sm(cases, c, frequency_Hz, deviation_m_s,
                       0.5 * std::numbers::pi * static_cast<double>(quarter));
    return cases;
}

std::vector<SmCase> sm_around(const Case& c, const SmCase& centre, double step,
                              const OptimiseOptions& options) {
    std::vector<SmCase> cases;
    const double turn_rad = two_pi;
    for (const double sign : {1.0, -1.0}) {
        const double phase_rad = centre.phase_rad + sign * step * 0.125 * turn_rad;
        add_sm(cases, c, centre.frequency_Hz, centre.deviation_m_s,
               phase_rad - turn_rad * std::floor(phase_rad / turn_rad));
        if (!options.sm_deviations_m_s.empty()) continue;
        const double deviation_m_s =
            std::min(centre.deviation_m_s + sign * step * deviation_step * speed_m_s(c),
                     largest_deviation * speed_m_s(c));
        if (deviation_m_s > 0.0 && deviation_m_s != centre.deviation_m_s)
            add_sm(cases, c, centre.frequency_Hz, deviation_m_s, centre.phase_rad);
    }
    return cases;
}

} // namespace shearwake::optimise
