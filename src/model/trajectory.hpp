#pragma once

#include "model/path.hpp"

#include <variant>
#include <vector>

namespace shearwake {

/// The focus rests.
struct Hold {
    Vec2 at_m;
    bool operator==(const Hold&) const = default;
};

enum class SwingWave { sine, triangle };

/// The focus goes to and fro about the origin: amplitude sin(2 pi f t + phase), or the triangle of
/// the same turning points at constant speed.
struct Swing {
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
using Motion = std::variant<ConstantSpeed, OscillatingSpeed>;

/// What happens when the path has been run through once: the focus goes out, rests, begins anew
/// (an open path with a jump) or turns back.
enum class AtEnd { off, hold, repeat, back_and_forth };

/// What a constant speed does at the corners of the path, and where a path that is run back and
/// forth turns: `dwell_s` of rest, and within `slow_within_m` before and after the speed falls at
/// a constant rate to the share `slow_to` of it and rises again.
struct CornerPace {
    double dwell_s = 0.0;
    double slow_within_m = 0.0;
    double slow_to = 1.0;
    bool operator==(const CornerPace&) const = default;
};

/// The focus moves along a path.
struct Travel {
    Curve path;
    Motion motion;
    AtEnd at_end = AtEnd::off;
    CornerPace corners;
    bool operator==(const Travel&) const = default;
};

using Mover = std::variant<Hold, Swing, Travel>;
/// Where the focus is. Parts ADD.
struct Trajectory {
    std::vector<Mover> parts;
    bool operator==(const Trajectory&) const = default;
};

/// Arc length run along at time t [m]; not bounded by any path's end.
double arc_length_m(const Motion& motion, double t_s);
/// Speed along the path at time t [m/s].
double speed_m_s(const Motion& motion, double t_s);
/// Largest |speed| that the motion ever reaches [m/s].
double greatest_speed_m_s(const Motion& motion);

/// Focus position at time t [m]. Beyond the end of a path it goes on along the last tangent
/// when the path switches off (see off_time_s), or rests when it holds.
Vec2 position(const Trajectory& trajectory, double t_s);
/// Focus velocity at time t [m/s], the exact derivative of `position`.
Vec2 velocity(const Trajectory& trajectory, double t_s);
/// When the focus goes out because a path has ended; infinity if never [s].
double off_time_s(const Trajectory& trajectory);
/// Largest speed that the focus ever reaches [m/s].
double greatest_speed_m_s(const Trajectory& trajectory);

/// Whether the focus runs straight on at one speed, or rests.
bool has_constant_velocity(const Trajectory& trajectory);

/// The frequency of the first part that swings or whose speed does; else, of two or more moving
/// parts, the highest with which one draws its path again and again; 0 if there is none [Hz].
double swing_frequency_Hz(const Trajectory& trajectory);

} // namespace shearwake
