// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "problem/case/case.hpp"

namespace shearwake {

template <class Walk, Is<HandAfferents> Places>
void walk_fields(Walk& walk, Places& places) {
    walk(places.part, {.text = "where"});
    walk(places.digit, {.key = "digit",
                        .range = Range::between(1.0, 5.0),
                        .applies = places.part == "fingertip",
                        .only_with = "where = \"fingertip\"",
                        .meaning = "number of the digit; 1 is the thumb"});
}

template <class Walk, Is<GridAfferents> Places>
void walk_fields(Walk& walk, Places& grid) {
    walk(grid.extent_m, {.key = "extent_mm",
                         .range = Range::between(0.0, 1e4),
                         .given = Given::required,
                         .meaning = "size of a grid centred in the domain"});
    walk(grid.pitch_m, {.key = "pitch_mm",
                        .range = Range::between(1e-3, 1e4),
                        .given = Given::required,
                        .meaning = "spacing of the grid"});
}

template <class Walk, Is<AfferentList> Places>
void walk_fields(Walk& walk, Places& list) {
    walk(list.all, {.key = "file",
                    .given = Given::by_hand,
                    .fallback = "required with where = \"csv\"",
                    .meaning = meaning_of_afferent_file()});
}

template <class Walk, Is<PinInput> Input>
void walk_fields(Walk&, Input&) {}

template <class Walk, Is<StressInput> Input>
void walk_fields(Walk&, Input&) {}

template <class Walk, Is<CarrierInput> Input>
void walk_fields(Walk& walk, Input& carrier) {
    walk(carrier.wave,
         {.key = "wave",
          .meaning =
              "how the displacement of the pins follows from the carrier c: c, max(c, 0) or c^2"});
    walk(carrier.frequency_Hz, {.key = "frequency_kHz",
                                .text = "carrier_Hz",
                                .range = Range::between(0.1, 1000.0),
                                .meaning = "frequency of the carrier"});
    walk(carrier.amplitude_m, {.key = "amplitude_um",
                               .range = Range::above(0.0),
                               .given = Given::required,
                               .meaning = "amplitude of the displacement"});
    walk(carrier.sampling_Hz, {.key = "sampling_kHz",
                               .range = Range::between(5.0, 1e5),
                               .fallback = "5 samples per cycle, at least 5 kHz",
                               .meaning = "samples per second"});
    walk(carrier.am_frequency_Hz, {.key = "am_frequency_Hz",
                                   .range = Range::between(0.0, 2000.0),
                                   .meaning = "frequency of the amplitude modulation; 0: none"});
    walk(carrier.am_depth, {.key = "am_depth",
                            .range = Range::between(0.0, 1.0),
                            .fallback = "1",
                            .meaning = "depth of the amplitude modulation"});
}

/// The fields of the response, which follow those of the places and of the input.
template <class Walk, Is<AfferentOptions> Options>
void walk_response(Walk& walk, Options& o) {
    walk(o.silence_s, {.key = "silence_ms",
                       .range = Range::between(0.0, 1e4),
                       .meaning = "duration of rest before the motion, and of a smooth return to "
                                  "rest after it; spikes outside the motion are discarded"});
    walk(o.periods,
         {.key = "periods",
          .range = Range::between(1.0, 1e4),
          .in_text = o.periods != AfferentOptions{}.periods,
          .meaning = "with `time.regime = \"periodic\"`: number of periods of the load in "
                     "which spikes count, after [a run-in](../explanation/receptors.md"
                     "#endless-loops)"});
    walk(o.noise, {.key = "noise", .meaning = "noise of the neuron model"});
    walk(o.conduction_delay,
         {.key = "conduction_delay", .meaning = "conduction delays along the nerve"});
}

template <class Walk, Is<AfferentOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk.choice(o.places, {.key = "where",
                           .text = "where",
                           .type = "word:palm|fingertip|hand|grid|csv",
                           .fallback = "`\"palm\"`",
                           .meaning = "`\"palm\"`, `\"fingertip\"`, `\"hand\"`: afferents at the "
                                      "published densities; `\"grid\"`: one afferent of each class "
                                      "at each grid point; `\"csv\"`: afferents from a file"});
    walk(o.classes, {.key = "classes",
                     .given = Given::by_hand,
                     .meaning = "classes of afferents; for `\"csv\"`, the file specifies them",
                     .least_count = 1});
    walk(o.seed, {.key = "seed",
                  .range = Range::between(0.0, 1e15),
                  .meaning = "seed of the random positions and neurons"});
    walk(o.patch_m, {.key = "patch_mm",
                     .fallback = "middle of the palm or fingertip",
                     .meaning = "position of the centre of the domain on the hand"});
    walk(o.patch_rad, {.key = "patch_deg",
                       .range = Range::between(-360.0, 360.0),
                       .meaning = "angle by which the domain is rotated on the hand"});
    walk(o.sheet, {.key = "skin",
                   .given = Given::by_hand,
                   .fallback = "`\"hand\"`; `\"flat\"` for `\"grid\"` and `\"csv\"`",
                   .meaning = "propagation of waves: within the outline of the `\"hand\"`, or on "
                              "an infinite `\"flat\"` sheet"});
    walk.choice(o.input,
                {.key = "input",
                 .text = "input",
                 .own_tables = true,
                 .meaning =
                     "`\"pins\"`: the simulated u_z at the pins; `\"stress\"`: the stress that "
                     "the engine computes at each receptor; `\"carrier\"`: pins move as "
                     "prescribed"});
    walk(o.pins_m,
         {.key = "pins_mm",
          .text = "pins_{}_m",
          .given = Given::by_hand,
          .fallback = "at the foci or along the path, one FWHM apart; `[[0, 0]]` for a carrier",
          .meaning = "positions `[[x, y], ...]` of the pins, at most 1000 (see "
                     "[receptors](../explanation/receptors.md)); or `pin_line` or `pin_grid`",
          .least_count = 1,
          .most_count = 1000});
    walk.key({.key = "pin_line",
              .type = "table",
              .fallback = "none",
              .meaning = "instead of `pins_mm`: pins along a line, `{ from_mm, to_mm, count }`"});
    walk.key(
        {.key = "pin_grid",
         .type = "table",
         .fallback = "none",
         .meaning = "instead of `pins_mm`: pins on a grid, `{ extent_mm, pitch_mm, center_mm }`"});
    walk(o.pin_radius_m, {.key = "pin_radius_mm",
                          .range = Range::above(0.0),
                          .meaning = "radius of the pins; if pins overlap, half of their smallest "
                                     "distance is used, with a warning"});
    walk_response(walk, o);
}

/// The keys from which config derives the points of a scan.
template <class Walk>
void walk_scan_keys(Walk& walk) {
    walk.key({.key = "grid_mm",
              .range = Range::above(0.0),
              .type = "point",
              .fallback = "one of the scans is required",
              .meaning = "scan: size `[x, y]` of a rectangle"});
    walk.key({.key = "polygon_mm",
              .type = "points",
              .fallback = "one of the scans is required",
              .meaning = "scan: corners `[[x, y], ...]` of an area"});
    walk.key({.key = "line_mm",
              .type = "points",
              .fallback = "one of the scans is required",
              .meaning = "scan: start and end `[[x, y], [x, y]]` of a line"});
    walk.key({.key = "file",
              .type = "file",
              .fallback = "one of the scans is required",
              .meaning = "scan: CSV file with the header `x_mm,y_mm` and one point per line; its "
                         "path is relative to the job file"});
    walk.key({.key = "spacing_mm",
              .range = Range::above(0.0),
              .type = "number",
              .fallback = "required unless the points are listed",
              .meaning = "distance of neighbouring points of a grid, area or line"});
    walk.key({.key = "center_mm",
              .type = "point",
              .fallback = "[0, 0]",
              .meaning = "with `grid_mm`: its centre"});
}

/// From the motion along the line of sight to the recorded samples.
template <class Walk, Is<VibrometerOptions> Options>
void walk_signal_fields(Walk& walk, Options& o) {
    walk(o.rate_Hz, {.key = "sampling_rate_kHz",
                     .range = Range::between(0.01, 10000.0),
                     .fallback = "one sample per frame",
                     .meaning = "sampling rate"});
    walk(o.high_pass_Hz, {.key = "high_pass_Hz",
                          .range = Range::between(0.1, 1e6),
                          .fallback = "none",
                          .meaning = "cutoff of the high-pass filter (Butterworth, second order)"});
    walk(o.low_pass_Hz, {.key = "low_pass_Hz",
                         .range = Range::between(0.1, 1e7),
                         .fallback = "none",
                         .meaning = "cutoff of the low-pass filter (Butterworth, second order)"});
    walk(o.noise_m_s_rtHz, {.key = "noise_um_s_rtHz",
                            .text = "noise_m_s_rtHz",
                            .range = Range::between(0.0, 1e6),
                            .given = Given::by_hand,
                            .fallback = "0",
                            .meaning = "one-sided density of the noise of the velocity, in um/s "
                                       "per square root of Hz"});
    walk(o.averages, {.key = "averages",
                      .range = Range::between(1, 1000000),
                      .meaning = "number of repetitions that are averaged at each point"});
    walk(o.trigger_delay_s, {.key = "trigger_delay_ms",
                             .range = Range::between(-1e5, 1e5),
                             .meaning = "time from the start of the load to the first sample; "
                                        "negative: the recording begins earlier"});
    walk(o.missing_share, {.key = "missing_percent",
                           .text = "missing_share",
                           .range = Range::between(0.0, 99.0),
                           .given = Given::by_hand,
                           .fallback = "0",
                           .meaning = "percentage of the points, chosen at random, that return no "
                                      "signal"});
    walk(o.seed, {.key = "seed",
                  .range = Range::between(0, 1000000000),
                  .meaning = "seed of the noise and of the missing points"});
}

template <class Walk, Is<VibrometerOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk_scan_keys(walk);
    walk(o.points_m, {.key = "points_mm",
                      .text = "points_{}_m",
                      .given = Given::by_hand,
                      .most_in_text = 100,
                      .fallback = "one of the scans is required",
                      .meaning = "scan: list of points `[[x, y], ...]`"});
    walk(o.tilt_rad, {.key = "tilt_deg",
                      .range = Range::between(0.0, 80.0),
                      .meaning = "angle between the line of sight and the normal of the skin; not "
                                 "0: engine `\"layered\"` with periodic edges"});
    walk(o.azimuth_rad, {.key = "azimuth_deg",
                         .meaning = "direction along the skin in which a tilted line of sight "
                                    "points, from x towards y"});
    walk(o.offset_x_m, {.key = "offset_x_mm",
                        .range = Range::between(-1000.0, 1000.0),
                        .meaning = "misalignment along x: true minus stated positions of the "
                                   "points"});
    walk(o.offset_y_m, {.key = "offset_y_mm",
                        .range = Range::between(-1000.0, 1000.0),
                        .meaning = "misalignment along y"});
    walk(o.spot_m, {.key = "spot_um",
                    .range = Range::between(0.0, 20000.0),
                    .meaning = "diameter of the laser spot, over which the motion is averaged"});
    walk_signal_fields(walk, o);
}

} // namespace shearwake
