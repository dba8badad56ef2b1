#include "model/modulation.hpp"

#include "base/error.hpp"
#include "base/overloaded.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

double length_m(const Line& line) {
    return norm(line.to_m - line.from_m);
}

Vec2 direction(const Line& line) {
    const double length = length_m(line);
    return length > 0.0 ? (1.0 / length) * (line.to_m - line.from_m) : Vec2{1.0, 0.0};
}

/// First time at which the motion has run the length of the path.
double end_time_s(const Travel& travel) {
    const double length = length_m(travel.path);
    const auto* oscillating = std::get_if<OscillatingSpeed>(&travel.motion);
    const double mean =
        oscillating ? oscillating->mean_m_s : std::get<ConstantSpeed>(travel.motion).speed_m_s;
    if (!(mean > 0.0)) return std::numeric_limits<double>::infinity();
    if (!oscillating || oscillating->deviation_m_s == 0.0) return length / mean;

    // s(t) = mean t + a bounded swing: the end lies within that swing of length / mean. Where the
    // speed never turns back s(t) is monotonic and bisection finds the crossing; where it does
    // turn back the first crossing is bracketed by steps of a hundredth of a period.
    const double swing_s =
        2.0 * std::abs(oscillating->deviation_m_s) / (two_pi * oscillating->frequency_Hz * mean);
    double low = std::max(0.0, length / mean - swing_s), high = length / mean + swing_s;
    const double step = 0.01 / oscillating->frequency_Hz;
    const auto beyond = [&](double t) { return arc_length_m(travel.motion, t) >= length; };
    if (beyond(low)) return low;
    for (double t = low; t < high; t += step) {
        if (beyond(t + step)) {
            low = t;
            high = t + step;
            break;
        }
    }
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (beyond(middle) ? high : low) = middle;
    }
    return high;
}

} // namespace

double arc_length_m(const Motion& motion, double t_s) {
    return std::visit(overloaded{
                          [&](const ConstantSpeed& m) { return m.speed_m_s * t_s; },
                          [&](const OscillatingSpeed& m) {
                              const double omega = two_pi * m.frequency_Hz;
                              // cos a - cos b = 2 sin((a+b)/2) sin((b-a)/2): exact as omega t goes
                              // to 0.
                              const double half = 0.5 * omega * t_s;
                              return m.mean_m_s * t_s +
                                     (omega > 0.0
                                          ? m.deviation_m_s / omega * 2.0 *
                                                std::sin(m.phase_rad + half) * std::sin(half)
                                          : m.deviation_m_s * std::sin(m.phase_rad) * t_s);
                          },
                      },
                      motion);
}

double speed_m_s(const Motion& motion, double t_s) {
    return std::visit(overloaded{
                          [&](const ConstantSpeed& m) { return m.speed_m_s; },
                          [&](const OscillatingSpeed& m) {
                              return m.mean_m_s +
                                     m.deviation_m_s *
                                         std::sin(two_pi * m.frequency_Hz * t_s + m.phase_rad);
                          },
                      },
                      motion);
}

double greatest_speed_m_s(const Motion& motion) {
    return std::visit(overloaded{
                          [](const ConstantSpeed& m) { return std::abs(m.speed_m_s); },
                          [](const OscillatingSpeed& m) {
                              return std::abs(m.mean_m_s) + std::abs(m.deviation_m_s);
                          },
                      },
                      motion);
}

Vec2 position(const Trajectory& trajectory, double t_s) {
    Vec2 sum;
    for (const Mover& part : trajectory.parts) {
        sum =
            sum + std::visit(overloaded{
                                 [&](const Hold& hold) { return hold.at_m; },
                                 [&](const Travel& travel) {
                                     double s = arc_length_m(travel.motion, t_s);
                                     if (travel.at_end == AtEnd::hold && t_s >= end_time_s(travel))
                                         s = length_m(travel.path);
                                     return travel.path.from_m + s * direction(travel.path);
                                 },
                             },
                             part);
    }
    return sum;
}

Vec2 velocity(const Trajectory& trajectory, double t_s) {
    Vec2 sum;
    for (const Mover& part : trajectory.parts) {
        const auto* travel = std::get_if<Travel>(&part);
        if (!travel) continue;
        if (travel->at_end == AtEnd::hold && t_s >= end_time_s(*travel)) continue;
        sum = sum + speed_m_s(travel->motion, t_s) * direction(travel->path);
    }
    return sum;
}

double off_time_s(const Trajectory& trajectory) {
    double off = std::numeric_limits<double>::infinity();
    for (const Mover& part : trajectory.parts) {
        const auto* travel = std::get_if<Travel>(&part);
        if (travel && travel->at_end == AtEnd::off) off = std::min(off, end_time_s(*travel));
    }
    return off;
}

double greatest_speed_m_s(const Trajectory& trajectory) {
    double sum = 0.0;
    for (const Mover& part : trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&part))
            sum += greatest_speed_m_s(travel->motion);
    return sum;
}

bool has_constant_speed(const Trajectory& trajectory) {
    return std::none_of(trajectory.parts.begin(), trajectory.parts.end(), [](const Mover& part) {
        const auto* travel = std::get_if<Travel>(&part);
        const auto* motion = travel ? std::get_if<OscillatingSpeed>(&travel->motion) : nullptr;
        return motion && motion->deviation_m_s != 0.0;
    });
}

double gain(const Envelope& envelope, double t_s) {
    double product = 1.0;
    for (const Gain& factor : envelope.gains) {
        product *= std::visit(
            overloaded{
                [&](const SineGain& g) {
                    const double drive =
                        1.0 - 0.5 * g.depth *
                                  (1.0 + std::cos(two_pi * g.frequency_Hz * t_s + g.phase_rad));
                    return g.on == GainOn::pressure ? drive * drive : drive;
                },
                [&](const RampGain& g) {
                    if (t_s >= g.duration_s) return 1.0;
                    return std::pow(std::sin(0.25 * two_pi * t_s / g.duration_s), 2);
                },
            },
            factor);
    }
    return product;
}

std::optional<double> modulation_frequency_Hz(const Modulation& modulation) {
    for (const Gain& factor : modulation.envelope.gains)
        if (const auto* sine = std::get_if<SineGain>(&factor); sine && sine->depth != 0.0)
            return sine->frequency_Hz;
    for (const Mover& part : modulation.trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&part))
            if (const auto* motion = std::get_if<OscillatingSpeed>(&travel->motion);
                motion && motion->deviation_m_s != 0.0)
                return motion->frequency_Hz;
    return std::nullopt;
}

double greatest_envelope_frequency_Hz(const Envelope& envelope) {
    double sum = 0.0;
    for (const Gain& factor : envelope.gains)
        sum += std::visit(
            overloaded{
                [](const SineGain& g) {
                    return g.on == GainOn::pressure ? 2.0 * g.frequency_Hz : g.frequency_Hz;
                },
                [](const RampGain& g) { return g.duration_s > 0.0 ? 2.0 / g.duration_s : 0.0; },
            },
            factor);
    return sum;
}

} // namespace shearwake
