// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/motion/path.hpp"

#include <variant>
#include <vector>

namespace shearwake {

/// The focus rests.
struct Hold {
    static constexpr const char* name = "hold";
    Vec2 at_m;
    bool operator==(const Hold&) const = default;
};

enum class SwingWave { sine, triangle };
constexpr auto names_of(std::type_identity<SwingWave>) {
    return std::array{"sine", "triangle"};
}

/// The focus oscillates around the origin: amplitude sin(2 pi f t + phase), or a triangle wave with
/// the same turning points at constant speed.
struct Swing {
    static constexpr const char* name = "swing";
    Vec2 amplitude_m;
    double frequency_Hz = 0.0;
    double phase_rad = 0.0;
    SwingWave wave = SwingWave::sine;
    bool operator==(const Swing&) const = default;
};

/// Arc length s(t) = speed t.
struct ConstantSpeed {
    double speed_m_s = 0.0;
    bool operator==(const ConstantSpeed&) const = default;
};

/// Speed v(t) = mean + deviation sin(2 pi f t + phase); s(t) is its exact integral.
struct OscillatingSpeed {
    double mean_m_s = 0.0;
    double deviation_m_s = 0.0;
    double frequency_Hz = 0.0;
    double phase_rad = 0.0;
    bool operator==(const OscillatingSpeed&) const = default;
};

/// The focus rests at one place after the other and jumps between them.
struct Rests {
    std::vector<double> arcs_m; // the places, as arc lengths of the path
    std::vector<double> ends_s; // of the rests, ascending, from the beginning of a pass
    std::vector<double> levels; // factors of the force; empty: 1
    bool operator==(const Rests&) const = default;

    /// The number of the rest at a time within a pass.
    std::size_t at(double t_s) const;
};

using Motion = std::variant<ConstantSpeed, OscillatingSpeed, Rests>;

/// What happens at the end of the path: the focus is switched off, rests, starts again at the
/// beginning (an open path with a jump), or turns back.
enum class AtEnd { off, hold, repeat, back_and_forth };
constexpr auto names_of(std::type_identity<AtEnd>) {
    return std::array{"off", "hold", "repeat", "back-and-forth"};
}

/// The change of a constant speed at the corners of the path, and at the ends of a path that is
/// traversed back and forth: a rest of `dwell_s`, and within `slow_within_m` before and after, a
/// change at a constant rate to the fraction `slow_to` of the speed and back.
struct CornerPace {
    double dwell_s = 0.0;
    double slow_within_m = 0.0;
    double slow_to = 1.0;
    bool operator==(const CornerPace&) const = default;
};

/// The focus moves along a path.
struct Travel {
    static constexpr const char* name_in_jobs = "path";
    Curve path;
    Motion motion;
    AtEnd at_end = AtEnd::off;
    CornerPace corners;
    bool operator==(const Travel&) const = default;
};

using Mover = std::variant<Hold, Swing, Travel>;
/// The position of the focus over time. Parts ADD.
struct Trajectory {
    std::vector<Mover> parts;
    bool operator==(const Trajectory&) const = default;
};

/// Arc length covered at time t [m]; not limited by the end of a path.
double arc_length_m(const Motion& motion, double t_s);
/// Speed along the path at time t [m/s].
double speed_m_s(const Motion& motion, double t_s);
/// Largest |speed| of the motion [m/s].
double greatest_speed_m_s(const Motion& motion);

/// Focus position at time t [m]. After the end of a path, it continues along the last tangent if
/// the focus is switched off (see off_time_s), or rests if it holds.
Vec2 position(const Trajectory& trajectory, double t_s);
/// Focus velocity at time t [m/s], the exact derivative of `position`.
Vec2 velocity(const Trajectory& trajectory, double t_s);
/// Appends numbers that do not change while `position` is a smooth function of time.
void add_smooth_pieces(const Trajectory& trajectory, double t_s, std::vector<double>& numbers);
/// The factor of the force that the rests of the focus state.
double level(const Trajectory& trajectory, double t_s);
/// When the focus goes out because a path has ended; infinity if never [s].
double off_time_s(const Trajectory& trajectory);
/// Largest speed that the focus ever reaches [m/s].
double greatest_speed_m_s(const Trajectory& trajectory);

/// Whether the focus runs straight on at one speed, or rests.
bool has_constant_velocity(const Trajectory& trajectory);

/// The frequency of the first part that swings or whose speed does; else, of two or more moving
/// parts, the highest with which one draws its path again and again; 0 if there is none [Hz].
double swing_frequency_Hz(const Trajectory& trajectory);

/// The arc length of a Travel along its path, and its speed (negative: backwards). Both are smooth
/// functions of time while `pass` and `stage` do not change: `stage` counts the parts of a pass
/// between rests and changes of the acceleration.
struct PathProgress {
    double arc_m = 0.0;
    double speed_m_s = 0.0;
    double pass = 0.0;
    std::ptrdiff_t stage = 0; // of rests: the number of the rest
};

/// Continues beyond the end of a path that is traversed once, independent of AtEnd.
PathProgress progress(const Travel& travel, double t_s);

/// Whether the path is traversed again after its end.
bool runs_again(const Travel& travel);
/// Arc length of one pass: the path, or there and back.
double cycle_m(const Travel& travel);
/// Number of stops in one pass: the corners, and the points at which it reverses.
std::ptrdiff_t stops(const Travel& travel);
/// The shortest arc between two stops, or twice that between a stop and an end without a stop.
double shortest_between_stops_m(const Travel& travel);

/// Duration of one pass; infinity if it never ends [s].
double cycle_s(const Travel& travel);
/// The constant speed for which one pass takes `cycle_s`, including rests and slow parts; not
/// positive if the rests alone take this time.
double speed_of_cycle_m_s(const Travel& travel, double cycle_s);

} // namespace shearwake
