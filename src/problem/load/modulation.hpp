// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/envelope.hpp"
#include "problem/load/motion/trajectory.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake {

/// A modulation: trajectory, envelope and foci. `kind` is its usual name ("AM-STM"), which has no
/// effect.
struct Modulation {
    std::string kind;
    Trajectory trajectory;
    Envelope envelope;
    /// Simultaneous foci relative to the moving point; they share the power of the single focus
    /// that is used if none are given.
    std::vector<Vec2> foci_m = {};
    bool operator==(const Modulation&) const = default;
};

/// The values of `am_wave` as the type of a key: the gains that are waves.
const char* am_wave_type();

/// The keys of the kinds with an amplitude modulation.
template <class Walk>
void walk_am_keys(Walk& walk) {
    walk.key({.key = "am_wave",
              .type = am_wave_type(),
              .fallback = "`\"sine\"`",
              .meaning = "of AM, AM-STM and DTP: shape of the amplitude modulation. The keys that "
                         "begin with `am_` are those of an envelope of that shape, see below"});
    walk.key({.key = "am_frequency_Hz",
              .range = modulation_range_Hz,
              .type = "number",
              .fallback = "required",
              .meaning = "frequency of the amplitude modulation"});
    walk.key({.key = "am_depth",
              .range = share_range,
              .type = "number",
              .fallback = "1",
              .meaning = "depth of the amplitude modulation"});
    walk.key({.key = "am_phase_deg",
              .type = "number",
              .fallback = "0",
              .meaning = "phase of the modulation"});
    walk.key({.key = "am_on",
              .type = "word:force|pressure",
              .fallback = "`\"force\"`",
              .meaning = "whether it acts on the force or on the acoustic pressure"});
    walk.key({.key = "am_duty",
              .range = Range::inside(0.0, 1.0),
              .type = "number",
              .fallback = "0.5",
              .meaning = "with `am_wave = \"square\"`: fraction of each period at full strength"});
    walk.key({.key = "am_edge_us",
              .range = Range::at_least(1.0),
              .type = "number",
              .fallback = "250, but at most half of the shorter part of a period",
              .meaning = "with `am_wave = \"square\"`: duration of the edges, which follow sin^2"});
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
    walk.key({.key = "lm_frequency_Hz",
              .range = Range::between(1e-3, 1e5),
              .type = "number",
              .fallback = "required",
              .meaning = "of LM: frequency of the motion"});
    walk.key({.key = "lm_phase_deg",
              .type = "number",
              .fallback = "0",
              .meaning = "phase of the modulation"});
    walk.key({.key = "lm_wave",
              .type = "word:sine|triangle",
              .fallback = "`\"sine\"`",
              .meaning = "of LM: `\"triangle\"` moves at constant speed"});
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
                           .type = "word:STM|AM|AM-STM|SM-STM|LM|DTP|STP|custom",
                           .fallback = "required",
                           .meaning = "kind of the modulation, see [job-file.md](job-file.md)"});
    walk.key({.key = "position_mm",
              .type = "point",
              .fallback = "[0, 0]",
              .meaning = "of AM and LM: position of the focus"});
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

/// Where the foci are at time t [m].
std::vector<Vec2> foci(const Modulation& modulation, double t_s);

/// The frequency of the first periodic part (envelope first, then trajectory), if there is one; a
/// single repeated path is not periodic in this sense [Hz].
std::optional<double> modulation_frequency_Hz(const Modulation& modulation);

} // namespace shearwake
