// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// The quantity that an envelope multiplies. The force is proportional to the square of the
/// acoustic pressure.
enum class GainOn { force, pressure };
constexpr auto names_of(std::type_identity<GainOn>) {
    return std::array{"force", "pressure"};
}

/// Allowed ranges of modulation frequencies and of fractions.
inline constexpr Range modulation_range_Hz = Range::between(1e-3, 1e5);
inline constexpr Range share_range = Range::between(0.0, 1.0);
/// Default duration of an edge, which the time samples of the engines resolve.
inline constexpr double usual_edge_s = 250e-6;

template <class Walk, Is<GainOn> On>
void walk_on(Walk& walk, On& on, Field field = {}) {
    field.key = "on";
    field.meaning = "quantity that the gain multiplies: the force, or the acoustic pressure, in "
                    "which case the force is multiplied by its square";
    walk(on, field);
}

/// Two numbers of a gain that contradict each other: the key to change, and what it must be.
struct GainConflict {
    const char* key = "";
    std::string message;
};

/// 1 - depth/2 (1 + cos(2 pi f t + phase)): from 1 - depth to 1; squared when on pressure.
struct SineGain {
    static constexpr const char* name = "sine";
    static constexpr bool is_wave = true; // of am_wave
    double frequency_Hz = 0.0;
    double depth = 1.0;
    double phase_rad = 0.0;
    GainOn on = GainOn::force;
    bool operator==(const SineGain&) const = default;
};

template <class Walk, Is<SineGain> G>
void walk_fields(Walk& walk, G& g) {
    walk(g.frequency_Hz,
         {.key = "frequency_Hz",
          .range = modulation_range_Hz,
          .given = Given::required,
          .meaning = "frequency f in the gain 1 - depth/2 (1 + cos(2 pi f t + phase))"});
    walk(g.depth,
         {.key = "depth", .range = share_range, .meaning = "depth: the gain falls to 1 - depth"});
    walk(g.phase_rad, {.key = "phase_deg", .meaning = "phase"});
    walk_on(walk, g.on);
}

/// Changes from `from` to `to` (by default 0 to 1) as sin^2, starting at `start_s` and over
/// `duration_s`: a load with a smooth start.
struct RampGain {
    static constexpr const char* name = "ramp";
    double duration_s = 0.0;
    double start_s = 0.0;
    double from = 0.0;
    double to = 1.0;
    GainOn on = GainOn::force;
    bool operator==(const RampGain&) const = default;
};

template <class Walk, Is<RampGain> G>
void walk_fields(Walk& walk, G& g) {
    const bool in_text = g != RampGain{.duration_s = g.duration_s};
    walk(g.duration_s, {.key = "duration_ms",
                        .range = Range::above(0.0),
                        .given = Given::required,
                        .meaning = "duration of the rise, which follows sin^2"});
    walk(g.start_s, {.key = "start_ms",
                     .range = Range::at_least(0.0),
                     .in_text = in_text,
                     .meaning = "time at which the rise begins"});
    walk(g.from, {.key = "from",
                  .range = share_range,
                  .in_text = in_text,
                  .meaning = "gain before the rise"});
    walk(g.to,
         {.key = "to", .range = share_range, .in_text = in_text, .meaning = "gain after the rise"});
    walk_on(walk, g.on, {.in_text = in_text});
}

/// 1 for the fraction `duty` of each period and 1 - depth for the rest; the period begins at phase
/// 0 with the rise. Rise and fall take `edge_s` each as sin^2, after the instant at which an ideal
/// square wave would jump.
struct SquareGain {
    static constexpr const char* name = "square";
    static constexpr bool is_wave = true;
    double frequency_Hz = 0.0;
    double duty = 0.5;
    double depth = 1.0;
    double phase_rad = 0.0;
    double edge_s = 0.0;
    GainOn on = GainOn::force;
    bool operator==(const SquareGain&) const = default;

    /// Chooses the duration of the edges if it is 0, not given, and compares the numbers.
    std::optional<GainConflict> complete();
};

template <class Walk, Is<SquareGain> G>
void walk_fields(Walk& walk, G& g) {
    walk(g.frequency_Hz, {.key = "frequency_Hz",
                          .range = modulation_range_Hz,
                          .given = Given::required,
                          .meaning = "number of periods per second"});
    walk(g.duty, {.key = "duty",
                  .range = Range::inside(0.0, 1.0),
                  .meaning = "fraction of each period at full strength"});
    walk(g.depth,
         {.key = "depth", .range = share_range, .meaning = "depth: the gain falls to 1 - depth"});
    walk(g.phase_rad, {.key = "phase_deg", .meaning = "phase"});
    walk(g.edge_s, {.key = "edge_us",
                    .range = Range::at_least(1.0),
                    .fallback = "250, but at most half of the shorter part of a period",
                    .meaning = "duration of the edges, which follow sin^2"});
    walk_on(walk, g.on);
}

/// 1 from `from_s` to `to_s`, 0 before and after; rises within `edge_s` after `from_s` and falls
/// within `edge_s` before `to_s`, as sin^2.
struct WindowGain {
    static constexpr const char* name = "window";
    double from_s = 0.0;
    double to_s = std::numeric_limits<double>::max();
    double edge_s = 0.0;
    GainOn on = GainOn::force;
    bool operator==(const WindowGain&) const = default;

    /// As for SquareGain.
    std::optional<GainConflict> complete();
};

template <class Walk, Is<WindowGain> G>
void walk_fields(Walk& walk, G& g) {
    walk(g.from_s, {.key = "from_ms",
                    .range = Range::at_least(0.0),
                    .meaning = "time at which the rise begins"});
    walk(g.to_s, {.key = "to_ms",
                  .range = Range::above(0.0),
                  .given = Given::required,
                  .meaning = "time at which the fall ends"});
    walk(g.edge_s, {.key = "edge_us",
                    .range = Range::at_least(1.0),
                    .fallback = "250, but at most half of the window",
                    .meaning = "duration of the edges, which follow sin^2"});
    walk_on(walk, g.on);
}

/// The largest number of samples that a job states, and of those in the text of a case, which is an
/// attribute of its file of at most 60 kB. More samples, of a file, are represented by their hash.
inline constexpr std::size_t most_samples = 2000;

/// Straight lines between `values` at t = 0, interval, 2 interval, ... The last value is held, or
/// the first one follows it and the gain has the period values.size() interval.
struct SampledGain {
    static constexpr const char* name = "samples";
    std::vector<double> values;
    double interval_s = 0.0;
    bool repeat = false;
    GainOn on = GainOn::force;
    bool operator==(const SampledGain&) const = default;

    double period_s() const { return static_cast<double>(values.size()) * interval_s; }
};

template <class Walk, Is<SampledGain> G>
void walk_fields(Walk& walk, G& g) {
    walk(g.values, {.key = "values",
                    .range = share_range,
                    .given = Given::required,
                    .most_in_text = most_samples,
                    .meaning = "gain at t = 0, one interval, two intervals, ..., with straight "
                               "lines between",
                    .least_count = 2,
                    .most_count = most_samples});
    walk(g.interval_s, {.key = "interval_us",
                        .range = Range::between(1.0, 1e6),
                        .given = Given::required,
                        .meaning = "time between the values"});
    walk(g.repeat, {.key = "repeat",
                    .meaning = "whether the values repeat, with a line from the last to the first; "
                               "otherwise the last value is held"});
    walk_on(walk, g.on);
}

using Gain = std::variant<SineGain, RampGain, SquareGain, WindowGain, SampledGain>;
/// The strength of the focus over time. Gains MULTIPLY.
struct Envelope {
    std::vector<Gain> gains;
    bool operator==(const Envelope&) const = default;
};

/// Gain in [0, 1] on the force at time t.
double gain(const Envelope& envelope, double t_s);

/// Appends numbers that do not change while `gain` is a smooth function of time.
void add_smooth_pieces(const Envelope& envelope, double t_s, std::vector<double>& numbers);

/// The frequency with which the gain repeats; 0 if it is steady or does not repeat [Hz].
double repetition_Hz(const Gain& gain);
/// Whether the gain rises or falls once, which a load that repeats for ever cannot.
bool acts_once(const Gain& gain);
/// Whether a gain that rises or falls once does not change in this time; false for others.
bool rests(const Gain& gain, double from_s, double to_s);

/// Whether a gain oscillates smoothly. The frequencies of others resolve their edges already.
bool is_smooth(const Gain& gain);
/// Duration and size of the edges of a gain; of samples, the lines between them.
struct Edge {
    double duration_s = 0.0; // 0: none, or a jump
    double size = 1.0;
};
Edge edge_of(const Gain& gain);

/// The largest value of a ramp or a window until a time, and 1 for other gains.
double largest(const Gain& gain, double end_s);

/// The frequency of the first periodic gain that is not steady; 0 if there is none [Hz].
double gain_frequency_Hz(const Envelope& envelope);

/// The highest frequency of the envelope of the force [Hz].
double greatest_envelope_frequency_Hz(const Envelope& envelope);

} // namespace shearwake
