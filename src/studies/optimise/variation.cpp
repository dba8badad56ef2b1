// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/forms.hpp"

#include "base/field.hpp"
#include "engines/registry/check.hpp"
#include "measures/window.hpp"
#include "problem/load/load.hpp"

#include <algorithm>
#include <cmath>

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
        if (auto* sampled = std::get_if<SampledGain>(&gain)) sampled->interval_s *= factor;
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

} // namespace shearwake::optimise
