// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/motion/trajectory.hpp"

#include "base/field.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake {
namespace {

bool has_ended(const Travel& travel, double t_s) {
    return travel.at_end == AtEnd::hold && !std::holds_alternative<Rests>(travel.motion) &&
           t_s >= cycle_s(travel);
}

/// The wave that starts at 0 with slope 2 pi f or 4 f: a sine, or a triangle with the same turning
/// points.
double swing(const Swing& s, double t_s) {
    const double angle = two_pi * s.frequency_Hz * t_s + s.phase_rad;
    if (s.wave == SwingWave::sine) return std::sin(angle);
    const double turns = angle / two_pi + 0.25;
    const double share = turns - std::floor(turns); // 0 at the lower turning point
    return 1.0 - std::abs(4.0 * share - 2.0);
}

double swing_rate(const Swing& s, double t_s) {
    const double angle = two_pi * s.frequency_Hz * t_s + s.phase_rad;
    if (s.wave == SwingWave::sine) return two_pi * s.frequency_Hz * std::cos(angle);
    const double turns = angle / two_pi + 0.25;
    return (turns - std::floor(turns) < 0.5 ? 4.0 : -4.0) * s.frequency_Hz;
}

bool moves(const Mover& part) {
    return std::visit(overloaded{[](const Hold&) { return false; },
                                 [](const Swing& s) { return norm(s.amplitude_m) > 0.0; },
                                 [](const Travel& travel) { return length_m(travel.path) > 0.0; }},
                      part);
}

/// The frequency with which the speed oscillates; 0 if it does not.
double oscillation_Hz(const Motion& motion) {
    return std::visit(overloaded{[](const ConstantSpeed&) { return 0.0; },
                                 [](const OscillatingSpeed& m) {
                                     return m.deviation_m_s != 0.0 ? m.frequency_Hz : 0.0;
                                 },
                                 [](const Rests&) { return 0.0; }},
                      motion);
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
                          [&](const Rests& m) { return m.arcs_m[m.at(t_s)]; },
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
                          [](const Rests&) { return 0.0; },
                      },
                      motion);
}

double greatest_speed_m_s(const Motion& motion) {
    return std::visit(overloaded{
                          [](const ConstantSpeed& m) { return std::abs(m.speed_m_s); },
                          [](const OscillatingSpeed& m) {
                              return std::abs(m.mean_m_s) + std::abs(m.deviation_m_s);
                          },
                          [](const Rests&) { return 0.0; },
                      },
                      motion);
}

Vec2 position(const Trajectory& trajectory, double t_s) {
    Vec2 sum;
    for (const Mover& part : trajectory.parts)
        sum = sum + std::visit(overloaded{
                                   [&](const Hold& hold) { return hold.at_m; },
                                   [&](const Swing& s) { return swing(s, t_s) * s.amplitude_m; },
                                   [&](const Travel& travel) {
                                       const double arc_m = has_ended(travel, t_s)
                                                                ? length_m(travel.path)
                                                                : progress(travel, t_s).arc_m;
                                       return point_m(travel.path, arc_m);
                                   },
                               },
                               part);
    return sum;
}

Vec2 velocity(const Trajectory& trajectory, double t_s) {
    Vec2 sum;
    for (const Mover& part : trajectory.parts)
        sum =
            sum + std::visit(overloaded{
                                 [](const Hold&) { return Vec2{}; },
                                 [&](const Swing& s) { return swing_rate(s, t_s) * s.amplitude_m; },
                                 [&](const Travel& travel) {
                                     if (has_ended(travel, t_s)) return Vec2{};
                                     const PathProgress now = progress(travel, t_s);
                                     return now.speed_m_s * tangent(travel.path, now.arc_m);
                                 },
                             },
                             part);
    return sum;
}

void add_smooth_pieces(const Trajectory& trajectory, double t_s, std::vector<double>& numbers) {
    const auto of_travel = [&](const Travel& travel) {
        if (has_ended(travel, t_s)) return numbers.push_back(-1.0);
        const PathProgress now = progress(travel, t_s);
        numbers.push_back(now.pass);
        numbers.push_back(static_cast<double>(now.stage));
        numbers.push_back(static_cast<double>(smooth_piece(travel.path, now.arc_m)));
    };
    for (const Mover& part : trajectory.parts)
        std::visit(overloaded{
                       [](const Hold&) {},
                       [&](const Swing& s) {
                           const double halves =
                               2.0 * s.frequency_Hz * t_s + 2.0 * s.phase_rad / two_pi + 0.5;
                           if (s.wave == SwingWave::triangle) numbers.push_back(std::floor(halves));
                       },
                       of_travel,
                   },
                   part);
}

std::size_t Rests::at(double t_s) const {
    const auto next = std::upper_bound(ends_s.begin(), ends_s.end(), t_s);
    return std::min(static_cast<std::size_t>(next - ends_s.begin()), ends_s.size() - 1);
}

double level(const Trajectory& trajectory, double t_s) {
    double product = 1.0;
    for (const Mover& part : trajectory.parts) {
        const auto* travel = std::get_if<Travel>(&part);
        const auto* rests = travel ? std::get_if<Rests>(&travel->motion) : nullptr;
        if (rests && !rests->levels.empty())
            product *= rests->levels[static_cast<std::size_t>(progress(*travel, t_s).stage)];
    }
    return product;
}

double off_time_s(const Trajectory& trajectory) {
    double off = std::numeric_limits<double>::infinity();
    const auto end = [&](const Travel& travel) {
        if (travel.at_end == AtEnd::off) off = std::min(off, cycle_s(travel));
    };
    for (const Mover& part : trajectory.parts)
        std::visit(overloaded{[](const Hold&) {}, [](const Swing&) {}, end}, part);
    return off;
}

double greatest_speed_m_s(const Trajectory& trajectory) {
    double sum = 0.0;
    for (const Mover& part : trajectory.parts)
        sum += std::visit(
            overloaded{[](const Hold&) { return 0.0; },
                       [](const Swing& s) {
                           return norm(s.amplitude_m) * s.frequency_Hz *
                                  (s.wave == SwingWave::sine ? two_pi : 4.0);
                       },
                       [](const Travel& travel) { return greatest_speed_m_s(travel.motion); }},
            part);
    return sum;
}

bool has_constant_velocity(const Trajectory& trajectory) {
    return std::ranges::none_of(trajectory.parts, [](const Mover& part) {
        const auto* travel = std::get_if<Travel>(&part);
        const bool is_straight = travel && !runs_again(*travel) &&
                                 std::holds_alternative<Line>(travel->path.shape) &&
                                 oscillation_Hz(travel->motion) == 0.0;
        return moves(part) && !is_straight;
    });
}

double swing_frequency_Hz(const Trajectory& trajectory) {
    double drawn_Hz = 0.0;
    const auto of_travel = [&](const Travel& travel) {
        const double frequency_Hz = oscillation_Hz(travel.motion);
        if (frequency_Hz == 0.0 && runs_again(travel))
            drawn_Hz = std::max(drawn_Hz, 1.0 / cycle_s(travel));
        return frequency_Hz;
    };
    for (const Mover& part : trajectory.parts) {
        if (!moves(part)) continue;
        const double frequency_Hz =
            std::visit(overloaded{[](const Hold&) { return 0.0; },
                                  [](const Swing& s) { return s.frequency_Hz; }, of_travel},
                       part);
        if (frequency_Hz > 0.0) return frequency_Hz;
    }
    const auto moving = std::count_if(trajectory.parts.begin(), trajectory.parts.end(), moves);
    return moving > 1 ? drawn_Hz : 0.0;
}

} // namespace shearwake
