// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/search/search.hpp"

#include "base/field.hpp"
#include "base/units.hpp"
#include "engines/registry/check.hpp"
#include "measures/window.hpp"
#include "problem/load/load.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace shearwake::optimise {
namespace {

Travel* travel_at_constant_speed(Case& c) {
    for (Mover& mover : c.scene.load.modulation.trajectory.parts)
        if (auto* travel = std::get_if<Travel>(&mover);
            travel && std::holds_alternative<ConstantSpeed>(travel->motion))
            return travel;
    return nullptr;
}

void scale_times(Case& c, double factor) {
    c.time.interval_s *= factor;
    c.measure.at_s *= factor;
    c.measure.settled_after_s *= factor;
    for (double& time_s : c.record.snapshots_s)
        time_s *= factor;
    for (Gain& gain : c.scene.load.modulation.envelope.gains)
        std::visit(overloaded{[&](SampledGain& sampled) { sampled.interval_s *= factor; },
                              [](SineGain&) {}, [](RampGain&) {}, [](SquareGain&) {},
                              [](WindowGain&) {}},
                   gain);
}

void scale_viscosity(ShearLoss& loss, double factor) {
    std::visit(
        overloaded{[](Lossless&) {}, [&](KelvinVoigt& l) { l.viscosity_Pa_s *= factor; },
                   [&](FractionalKelvinVoigt& l) { l.tau_s *= std::pow(factor, 1.0 / l.exponent); },
                   [&](StandardLinearSolid& l) { l.strength *= factor; }},
        loss);
}

} // namespace

bool can_be_computed(const Case& c) {
    const Modulation& modulation = c.scene.load.modulation;
    if (c.time.regime == Regime::periodic) {
        const LoadPeriod period = least_period(c.scene.load, 1.01 * c.time.duration_s());
        if (!period.reason.empty()) return false;
        const double periods = c.time.duration_s() / period.period_s;
        if (std::abs(periods - std::round(periods)) > 1e-6) return false;
    }
    if (!measures::period_window(c.measure, c.time, modulation_frequency_Hz(modulation),
                                 off_time_s(modulation.trajectory))
             .fits())
        return false;
    return std::ranges::none_of(
        check(c), [](const Remark& remark) { return remark.severity == Severity::error; });
}

bool has_speed(const Case& c) {
    Case copy = c;
    const Travel* travel = travel_at_constant_speed(copy);
    return travel && travel->corners == CornerPace{};
}

double speed_m_s(const Case& c) {
    Case copy = c;
    return std::get<ConstantSpeed>(travel_at_constant_speed(copy)->motion).speed_m_s;
}

Case with_oscillating_speed(Case c, double frequency_Hz, double deviation_m_s, double phase_rad) {
    travel_at_constant_speed(c)->motion = OscillatingSpeed{.mean_m_s = speed_m_s(c),
                                                           .deviation_m_s = deviation_m_s,
                                                           .frequency_Hz = frequency_Hz,
                                                           .phase_rad = phase_rad};
    return c;
}

std::optional<Case> with_motion(const Case& c, const MotionChange& change) {
    Case changed = c;
    Travel& travel = *travel_at_constant_speed(changed);
    if (change.size != 1.0) travel.path = scaled(travel.path, change.size);
    const double speed = change.speed * speed_m_s(c);
    travel.motion = ConstantSpeed{speed};
    scale_times(changed, change.size / change.speed);
    const double deviation = std::hypot(change.sine, change.cosine);
    if (change.periods > 0 && deviation > 0.0) {
        const measures::PeriodWindow window =
            measures::period_window(changed.measure, changed.time, std::nullopt);
        changed = with_oscillating_speed(changed, change.periods / (window.to_s - window.from_s),
                                         deviation * speed, std::atan2(change.cosine, change.sine));
    }
    if (!can_be_computed(changed)) return std::nullopt;
    return changed;
}

std::vector<MotionChange> changes_around(const MotionChange& centre, double step,
                                         const OptimiseOptions& options) {
    std::vector<MotionChange> changes;
    const auto add = [&](auto change) {
        MotionChange next = centre;
        change(next);
        if (next != centre) changes.push_back(next);
    };
    // A step of 1 reaches the largest factor or half of the largest deviation.
    const double limit = options.factor_at_most, factor = std::pow(limit, step);
    const auto within = [&](double value) { return std::clamp(value, 1.0 / limit, limit); };
    for (const OptimisedPart part : options.over)
        for (const double sign : {1.0, -1.0}) {
            const double by = sign > 0.0 ? factor : 1.0 / factor;
            const double deviation = sign * 0.5 * step * largest_deviation;
            if (part == OptimisedPart::speed)
                add([&](MotionChange& m) { m.speed = within(m.speed * by); });
            if (part == OptimisedPart::size)
                add([&](MotionChange& m) { m.size = within(m.size * by); });
            if (part != OptimisedPart::speed_profile) continue;
            // At constant speed, the number of periods is free.
            for (const int periods :
                 centre.periods > 0 ? std::vector{centre.periods} : std::vector{1, 2, 3}) {
                add([&](MotionChange& m) {
                    m.periods = periods;
                    m.sine += deviation;
                });
                add([&](MotionChange& m) {
                    m.periods = periods;
                    m.cosine += deviation;
                });
            }
        }
    std::erase_if(changes, [](const MotionChange& m) {
        return std::hypot(m.sine, m.cosine) > largest_deviation;
    });
    return changes;
}

std::vector<Difference> differences_by(double relative) {
    std::vector<Difference> differences;
    const auto percent = [](double factor) {
        return fmt::format("{:+.0f} %", 100.0 * (factor - 1.0));
    };
    const std::vector<double> factors = {1.0 - relative, 1.0, 1.0 + relative};
    for (const double c_s : factors)
        for (const double viscosity : factors) {
            if (c_s == 1.0 && viscosity == 1.0) continue;
            std::string name = c_s == 1.0 ? "" : "c_s " + percent(c_s);
            if (viscosity != 1.0)
                name += (name.empty() ? "" : ", ") + ("viscosity " + percent(viscosity));
            differences.push_back({.name = std::move(name), .c_s = c_s, .viscosity = viscosity});
        }
    for (const double speed : factors)
        if (speed != 1.0)
            differences.push_back({.name = "speed " + percent(speed), .speed = speed});
    return differences;
}

std::optional<Case> with_difference(const Case& c, const Difference& difference) {
    Case changed = c;
    for (Layer& layer : changed.scene.medium.layers) {
        layer.c_s_m_s *= difference.c_s;
        scale_viscosity(layer.loss, difference.viscosity);
    }
    if (difference.speed != 1.0) {
        if (!has_speed(changed)) return std::nullopt;
        return with_motion(changed, {.speed = difference.speed});
    }
    if (!can_be_computed(changed)) return std::nullopt;
    return changed;
}

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
