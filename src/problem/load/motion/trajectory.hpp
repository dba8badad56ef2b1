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

template <class Walk, Is<Hold> H>
void walk_fields(Walk& walk, H& hold) {
    walk(hold.at_m, {.key = "position_mm",
                     .text = "at_m",
                     .given = Given::required,
                     .meaning = "position at which the focus rests"});
}

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

template <class Walk, Is<Swing> S>
void walk_fields(Walk& walk, S& swing) {
    walk(swing.amplitude_m, {.key = "amplitude_mm",
                             .given = Given::required,
                             .meaning = "amplitude `[x, y]`: a in a sin(2 pi f t + phase)"});
    walk(swing.frequency_Hz, {.key = "frequency_Hz",
                              .range = Range::between(1e-3, 1e5),
                              .given = Given::required,
                              .meaning = "frequency f"});
    walk(swing.phase_rad, {.key = "phase_deg", .meaning = "phase"});
    walk(swing.wave,
         {.key = "wave",
          .meaning = "`\"sine\"`, or `\"triangle\"`: back and forth at constant speed"});
}

/// Arc length s(t) = speed t.
struct ConstantSpeed {
    double speed_m_s = 0.0;
    bool operator==(const ConstantSpeed&) const = default;
};

template <class Walk, Is<ConstantSpeed> Speed>
void walk_fields(Walk& walk, Speed& speed) {
    walk(speed.speed_m_s, {.text = "speed_m_s"});
}
/// Speed v(t) = mean + deviation sin(2 pi f t + phase); s(t) is its exact integral.
struct OscillatingSpeed {
    double mean_m_s = 0.0;
    double deviation_m_s = 0.0;
    double frequency_Hz = 0.0;
    double phase_rad = 0.0;
    bool operator==(const OscillatingSpeed&) const = default;
};

template <class Walk, Is<OscillatingSpeed> Speed>
void walk_fields(Walk& walk, Speed& speed) {
    walk(speed.mean_m_s, {.text = "speed_mean_m_s"});
    walk(speed.deviation_m_s,
         {.key = "speed_deviation_m_s",
          .range = Range::at_least(0.0),
          .given = Given::required,
          .fallback = "required for SM-STM",
          .meaning = "of SM-STM: dv in the speed v + dv sin(2 pi f t + phase)"});
    walk(speed.frequency_Hz, {.key = "sm_frequency_Hz",
                              .text = "speed_frequency_Hz",
                              .range = Range::between(1e-3, 1e5),
                              .given = Given::required,
                              .fallback = "required for SM-STM",
                              .meaning = "of SM-STM: frequency f of the speed"});
    walk(speed.phase_rad, {.key = "sm_phase_deg",
                           .text = "speed_phase_rad",
                           .meaning = "of SM-STM: phase of the speed"});
}
/// The focus rests at one place after the other and jumps between them.
struct Rests {
    std::vector<double> arcs_m; // the places, as arc lengths of the path
    std::vector<double> ends_s; // of the rests, ascending, from the beginning of a pass
    std::vector<double> levels; // factors of the force; empty: 1
    bool operator==(const Rests&) const = default;

    /// The number of the rest at a time within a pass.
    std::size_t at(double t_s) const;
};

template <class Walk, Is<Rests> R>
void walk_fields(Walk& walk, R& rests) {
    walk(rests.arcs_m, {.text = "rests_m", .most_in_text = 100});
    walk(rests.ends_s, {.text = "rest_ends_s", .most_in_text = 100});
    walk(rests.levels, {.text = "rest_levels", .most_in_text = 100});
}

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

template <class Walk, Is<CornerPace> Pace>
void walk_fields(Walk& walk, Pace& pace) {
    const bool in_text = pace != CornerPace{};
    walk(pace.dwell_s,
         {.key = "corner_dwell_ms",
          .range = Range::at_least(0.0),
          .in_text = in_text,
          .meaning = "duration of the rest at each corner of the path, and at the ends of a path "
                     "that is traversed back and forth (kinds with constant speed: STM, AM-STM, "
                     "DTP, STP). A corner turns by 20 degrees or more; a closed path that starts "
                     "at a corner begins with a rest"});
    walk(pace.slow_within_m,
         {.key = "corner_slow_mm",
          .text = "corner_slow_within_m",
          .range = Range::at_least(0.0),
          .in_text = in_text,
          .meaning = "distance before each corner over which the focus slows down to "
                     "`corner_slow_to` times its speed, and distance after the corner over which "
                     "it accelerates again, both at a constant rate"});
    walk(pace.slow_to,
         {.key = "corner_slow_to",
          .range = Range::between(0.01, 1.0),
          .in_text = in_text,
          .meaning =
              "speed at a corner, as a fraction of the speed elsewhere; see `corner_slow_mm`"});
}

/// The focus moves along a path.
struct Travel {
    static constexpr const char* name_in_jobs = "path";
    Curve path;
    Motion motion;
    AtEnd at_end = AtEnd::off;
    CornerPace corners;
    bool operator==(const Travel&) const = default;
};

template <class Walk, Is<Travel> T>
void walk_fields(Walk& walk, T& travel) {
    walk.choice(travel.path.shape, {.key = "path.shape",
                                    .text = "mover",
                                    .type = path_words,
                                    .fallback = "required",
                                    .meaning = "shape of the path"});
    walk(travel.at_end,
         {.key = "path.at_end",
          .text = "at_end",
          .given = Given::by_hand,
          .fallback = "`\"repeat\"` for closed paths, `\"off\"` for open ones",
          .meaning = "what happens at the end of the path: the focus is switched off, rests, "
                     "starts again at the beginning (an open path with a jump), or turns back"});
    walk.key({.key = "speed_m_s",
              .range = Range::between(1e-6, 1000.0),
              .given = Given::by_hand,
              .type = "number",
              .fallback = "required",
              .meaning = "speed (its mean, if it oscillates); or `mach`, or `draw_frequency_Hz`"});
    walk.key({.key = "mach",
              .range = Range::between(1e-6, 1000.0),
              .type = "number",
              .fallback = "none",
              .meaning = "instead of `speed_m_s`: the speed divided by c_s of the top layer"});
    walk.key({.key = "draw_frequency_Hz",
              .range = Range::between(1e-3, 1e5),
              .type = "number",
              .fallback = "none",
              .meaning = "instead of `speed_m_s`: number of passes along the path per second, "
                         "rests included (there and back is one pass)"});
    walk.choice(travel.motion, {});
    walk_fields(walk, travel.corners);
}

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
