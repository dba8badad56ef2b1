#pragma once

#include <limits>
#include <variant>
#include <vector>

namespace shearwake {

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
/// From `from` to `to` (0 to 1 if not given) beginning at `start_s`, within `duration_s`, as sin^2:
/// a load that starts gently.
struct RampGain {
    double duration_s = 0.0;
    double start_s = 0.0;
    double from = 0.0;
    double to = 1.0;
    GainOn on = GainOn::force;
    bool operator==(const RampGain&) const = default;
};
/// 1 for the share `duty` of each period and 1 - depth for the rest; the period begins at the
/// phase 0 with the rise. Rise and fall take `edge_s` each as sin^2, after the instant at which an
/// ideal square wave would jump.
struct SquareGain {
    double frequency_Hz = 0.0;
    double duty = 0.5;
    double depth = 1.0;
    double phase_rad = 0.0;
    double edge_s = 0.0;
    GainOn on = GainOn::force;
    bool operator==(const SquareGain&) const = default;
};
/// 1 from `from_s` to `to_s`, 0 before and after; rises within `edge_s` after the one and falls
/// within `edge_s` before the other, as sin^2.
struct WindowGain {
    double from_s = 0.0;
    double to_s = std::numeric_limits<double>::max();
    double edge_s = 0.0;
    GainOn on = GainOn::force;
    bool operator==(const WindowGain&) const = default;
};

using Gain = std::variant<SineGain, RampGain, SquareGain, WindowGain>;
/// How strong the focus is. Gains MULTIPLY.
struct Envelope {
    std::vector<Gain> gains;
    bool operator==(const Envelope&) const = default;
};

/// Gain in [0, 1] on the force at time t.
double gain(const Envelope& envelope, double t_s);

/// The frequency of the first periodic gain that is not steady; 0 if there is none [Hz].
double gain_frequency_Hz(const Envelope& envelope);

/// The highest frequency that the envelope puts on the force [Hz].
double greatest_envelope_frequency_Hz(const Envelope& envelope);

} // namespace shearwake
