// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "problem/load/footprint_fields.hpp"
#include "problem/load/load.hpp"

#include <set>
#include <string>

namespace shearwake {

template <class Walk, Is<Hold> H>
void walk_fields(Walk& walk, H& hold) {
    walk(hold.at_m, {.key = "position_mm",
                     .text = "at_m",
                     .given = Given::required,
                     .meaning = "position at which the focus rests"});
}

template <class Walk, Is<Swing> S>
void walk_fields(Walk& walk, S& swing) {
    walk(swing.amplitude_m, {.key = "amplitude_mm",
                             .given = Given::required,
                             .meaning = "amplitude `[x, y]`: a in a sin(2 pi f t + phase)"});
    walk(swing.frequency_Hz, {.key = "frequency_Hz",
                              .range = Range::between(1e-3, 1e5),
                              .given = Given::required,
                              .meaning = "frequency f in a sin(2 pi f t + phase)"});
    walk(swing.phase_rad, {.key = "phase_deg", .meaning = "phase"});
    walk(swing.wave,
         {.key = "wave",
          .meaning = "`\"sine\"`, or `\"triangle\"`: back and forth at constant speed"});
}

template <class Walk, Is<ConstantSpeed> Speed>
void walk_fields(Walk& walk, Speed& speed) {
    walk(speed.speed_m_s, {.text = "speed_m_s"});
}

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

template <class Walk, Is<Rests> R>
void walk_fields(Walk& walk, R& rests) {
    walk(rests.arcs_m, {.text = "rests_m", .most_in_text = 100});
    walk(rests.ends_s, {.text = "rest_ends_s", .most_in_text = 100});
    walk(rests.levels, {.text = "rest_levels", .most_in_text = 100});
}

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

/// Calls use(example, field, wave) for the keys `am_...`: those of the gains that are waves. Keys
/// that the first of them lacks apply with the wave that has them.
void each_am_key(const auto& use) {
    std::set<std::string> known;
    bool is_first = true;
    for_each_alternative(std::type_identity<Gain>{}, [&]<class G>(const G& wave) {
        if constexpr (requires { G::is_wave; }) {
            const PrefixedWalk walk{"am_", [&](const auto& example, Field field) {
                                        static const std::string only =
                                            "am_wave = \"" + std::string(G::name) + "\"";
                                        if (!is_first) field.only_with = only.c_str();
                                        if (known.insert(field.key).second)
                                            use(example, field, G::name);
                                    }};
            walk_fields(walk, wave);
            is_first = false;
        }
    });
}

/// The keys of the kinds with an amplitude modulation.
template <class Walk>
void walk_am_keys(Walk& walk) {
    walk.key({.key = "am_wave",
              .type = am_wave_type(),
              .fallback = "`\"sine\"`",
              .meaning = "of AM, AM-STM and DTP: shape of the amplitude modulation. The keys that "
                         "begin with `am_` are those of an envelope of that shape, see below"});
    each_am_key(
        [&](const auto& example, const Field& field, const char*) { walk.key(example, field); });
}

/// The keys of lateral modulation and of the patterns of STP.
template <class Walk>
void walk_lateral_keys(Walk& walk) {
    walk.key({.key = "lm_amplitude_mm",
              .range = Range::between(0.0, 1e3),
              .type = "number",
              .fallback = "required",
              .meaning = "of LM: half the length of the line"});
    walk.key({.key = "lm_angle_deg",
              .type = "number",
              .fallback = "0",
              .meaning = "of LM: direction of the line, from x towards y"});
    const PrefixedWalk lateral_keys{"lm_", [&](const auto& example, const Field& field) {
                                        if (std::string_view(field.key) != "lm_amplitude_mm")
                                            walk.key(example, field);
                                    }};
    const Swing swing;
    walk_fields(lateral_keys, swing);
    walk.key(
        {.key = "pattern",
         .type = "path",
         .fallback = "required",
         .meaning =
             "of STP: path around the moving centre. Open paths are traversed back and forth"});
    walk.key({.key = "pattern_frequency_Hz",
              .range = Range::between(1e-3, 1e5),
              .type = "number",
              .fallback = "required",
              .meaning = "of STP: number of times per second that the pattern is drawn"});
}

template <class Walk, Is<Modulation> M>
void walk_fields(Walk& walk, M& modulation) {
    walk(modulation.kind, {.key = "kind",
                           .given = Given::by_hand,
                           .type = "word:STM|AM|AM-STM|SM-STM|LM|DTP|STP|custom|file",
                           .fallback = "required",
                           .meaning = "kind of the modulation, see [job-file.md](job-file.md)"});
    walk.key({.key = "position_mm",
              .type = "point",
              .fallback = "[0, 0]",
              .meaning = "of AM, LM and an envelope in a file: position of the focus"});
    walk.key({.key = "file",
              .type = "file",
              .fallback = "required",
              .meaning = "of kind file: what a device plays (points, an envelope, or phases of an "
                         "array), relative to the job file; see [job-file.md](job-file.md)"});
    walk.key({.key = "at_end",
              .type = "word:repeat|hold|off",
              .fallback = "`\"repeat\"`",
              .meaning = "of kind file: what happens after its end"});
    walk.key({.key = "path",
              .type = "path",
              .fallback = "required",
              .meaning = "path of STM, AM-STM, SM-STM, DTP and STP: a table `{ shape = ..., at_end "
                         "= ... }` with the `path.` keys listed under `move = \"path\"` below. "
                         "`speed_m_s`, `corner_dwell_ms` and the other keys without `path.` belong "
                         "directly in `[load.modulation]`"});
    walk_am_keys(walk);
    walk_lateral_keys(walk);
    walk(modulation.foci_m,
         {.key = "foci_mm",
          .text = "foci_{}_m",
          .given = Given::by_hand,
          .in_text = !modulation.foci_m.empty(),
          .fallback = "one focus",
          .meaning =
              "`[[x, y], ...]`: positions of simultaneous foci relative to the moving or "
              "resting point. They share the power of one focus: each of n Gaussian foci "
              "has 1/n of `peak_Pa`, and the pistons of an array radiate as much power as "
              "for one focus. The focal disc of the measures is then a disc around each of them",
          .least_count = 1});
    walk.key(
        {.key = "ramp_ms",
         .range = Range::above(0.0),
         .type = "number",
         .fallback = "none",
         .meaning =
             "duration over which the load rises smoothly; without it, the load starts abruptly"});
    walk.each(
        "load.modulation.trajectory", modulation.trajectory.parts,
        {.key = "move",
         .text = "mover",
         .meaning = "kind of the motion: a fixed point, an oscillation along a line, or a path"});
    walk.each("load.modulation.envelope", modulation.envelope.gains,
              {.key = "shape", .text = "gain", .meaning = "shape of the gain over time"});
}

template <class Walk, Is<AveragedCarrier> C>
void walk_fields(Walk&, C&) {}

template <class Walk, Is<ResolvedCarrier> C>
void walk_fields(Walk& walk, C& carrier) {
    walk(carrier.frequency_Hz, {.key = "carrier_kHz",
                                .range = Range::between(1.0, 1000.0),
                                .meaning = "f_c, the frequency of the ultrasound"});
}

template <class Walk, Is<Load> L>
void walk_fields(Walk& walk, L& load) {
    walk.section("load");
    walk(load.peak_Pa, {.key = "peak_Pa",
                        .range = Range::above(0.0),
                        .given = Given::by_hand,
                        .fallback = "required",
                        .meaning = "radiation pressure at the centre of the focus; for an array: "
                                   "when it focuses on the point below its centre"});
    walk.choice(load.footprint, {.key = "footprint.shape",
                                 .text = "footprint",
                                 .meaning = "shape of the pressure distribution"});
    walk.choice(load.carrier,
                {.key = "carrier",
                 .text = "carrier",
                 .meaning = "`\"averaged\"`: the force is averaged over the cycle of the "
                            "ultrasound; `\"resolved\"`: it is multiplied by 1 + cos(2 pi f_c t)"});
    walk.section("load.modulation");
    walk_fields(walk, load.modulation);
}

} // namespace shearwake
