#pragma once

#include "base/vec2.hpp"

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

// ---- Trajectory: where the focus is. Parts ADD. -------------------------------------------------

/// The focus rests.
struct Hold {
    Vec2 at_m;
    bool operator==(const Hold&) const = default;
};

/// A straight path, run along by its arc length.
struct Line {
    Vec2 from_m;
    Vec2 to_m;
    bool operator==(const Line&) const = default;
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

/// What happens when the path has been run through once.
enum class AtEnd { off, hold };

/// The focus moves along a path.
struct Travel {
    Line path;
    Motion motion;
    AtEnd at_end = AtEnd::off;
    bool operator==(const Travel&) const = default;
};

using Mover = std::variant<Hold, Travel>;
struct Trajectory {
    std::vector<Mover> parts;
    bool operator==(const Trajectory&) const = default;
};

// ---- Envelope: how strong it is. Gains MULTIPLY.
// -------------------------------------------------

/// What an envelope is applied to. The force goes with the square of the acoustic pressure.
enum class GainOn { force, pressure };

/// 1 - depth/2 (1 + cos(2 pi f t + phase)): from 1 - depth to 1; squared when on pressure.
struct SineGain {
    double frequency_Hz = 0.0;
    double depth = 1.0;
    double phase_rad = 0.0;
    GainOn on = GainOn::force;
    bool operator==(const SineGain&) const = default;
};
/// Rises from 0 to 1 within `duration_s` as sin^2: a load that starts gently.
struct RampGain {
    double duration_s = 0.0;
    bool operator==(const RampGain&) const = default;
};
using Gain = std::variant<SineGain, RampGain>;
struct Envelope {
    std::vector<Gain> gains;
    bool operator==(const Envelope&) const = default;
};

/// A named composition. `kind` is the field's name for it ("AM-STM"); it decides nothing.
struct Modulation {
    std::string kind;
    Trajectory trajectory;
    Envelope envelope;
    bool operator==(const Modulation&) const = default;
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

/// Whether the focus moves at one speed throughout.
bool has_constant_speed(const Trajectory& trajectory);

/// Gain in [0, 1] on the force at time t.
double gain(const Envelope& envelope, double t_s);

/// The frequency of the first periodic part (envelope first, then motion), if there is one [Hz].
std::optional<double> modulation_frequency_Hz(const Modulation& modulation);

/// The highest frequency that the envelope puts on the force [Hz].
double greatest_envelope_frequency_Hz(const Envelope& envelope);

} // namespace shearwake
