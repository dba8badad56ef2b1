// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/acoustics/lens.hpp"
#include "problem/load/acoustics/patch.hpp"
#include "problem/load/footprint.hpp"

namespace shearwake {

template <class Walk, Is<GaussianFootprint> Footprint>
void walk_fields(Walk& walk, Footprint& f) {
    walk(f.fwhm_m, {.key = "fwhm_mm",
                    .range = Range::between(0.01, 1000.0),
                    .given = Given::required,
                    .meaning = "full width at half maximum"});
}

/// The keys from which config derives the peak pressure of an array.
template <class Walk>
void walk_pressure_keys(Walk& walk) {
    walk.key(
        {.key = "pressure_Pa_m",
         .range = Range::above(0.0),
         .type = "number",
         .fallback = "`load.peak_Pa`",
         .meaning =
             "pressure of one piston on its axis, multiplied by the distance; replaces `peak_Pa`"});
    walk.key(
        {.key = "air_density_kg_m3",
         .range = Range::above(0.0),
         .type = "number",
         .fallback = "1.184",
         .meaning = "with `pressure_Pa_m`: density of air; the default is for 25 degrees Celsius"});
}

template <class Walk, Is<ArrayFootprint> Footprint>
void walk_piston_fields(Walk& walk, Footprint& array) {
    walk.key({.key = "preset",
              .type = "word",
              .fallback = "none",
              .meaning =
                  "`\"array-16x16\"`, or `\"array-249\"` (18 x 14 positions at 10.16 mm, three "
                  "of them empty); supplies `elements`, `missing`, `pitch_mm` and `radius_mm`"});
    walk.key({.key = "elements",
              .range = Range::between(1, 100),
              .given = Given::preset,
              .type = "point",
              .meaning = "number of pistons along x and y, such as `[16, 16]`"});
    walk(array.columns, {.text = "columns"});
    walk(array.rows, {.text = "rows"});
    walk(array.pitch_m, {.key = "pitch_mm",
                         .range = Range::between(1.0, 100.0),
                         .given = Given::preset,
                         .meaning = "distance between the centres of neighbouring pistons"});
    walk(array.radius_m, {.key = "radius_mm",
                          .range = Range::between(0.1, 50.0),
                          .given = Given::preset,
                          .meaning = "radius of a piston"});
}

template <class Walk, Is<ArrayFootprint> Footprint>
void walk_fields(Walk& walk, Footprint& array) {
    walk_piston_fields(walk, array);
    walk(array.distance_m, {.key = "distance_mm",
                            .range = Range::between(20.0, 2000.0),
                            .given = Given::required,
                            .meaning = "distance of the array from the skin"});
    walk(array.center_m,
         {.key = "center_mm", .meaning = "point of the skin below the centre of the array"});
    walk_sound_fields(walk, array);
    walk(array.missing,
         {.key = "missing",
          .text = "missing",
          .given = Given::by_hand,
          .type = "points",
          .meaning = "`[[2, 2], ...]`, positions [column, row] without a piston, counted from 1"});
    walk(array.phase_levels,
         {.key = "phase_levels",
          .range = Range::between(2, 65536),
          .fallback = "phases are not rounded",
          .meaning = "number of levels to which the phase of each piston is rounded"});
    walk(array.update_rate_Hz,
         {.key = "update_rate_kHz",
          .range = Range::between(0.01, 1000.0),
          .fallback = "continuous",
          .meaning =
              "rate at which the position of the focus is updated; it rests between updates"});
    walk(array.hologram,
         {.key = "hologram",
          .in_text = array.hologram != Hologram::superposition,
          .meaning =
              "drives of the pistons for several `foci_mm`. `\"superposition\"`: the sum of "
              "the drives for each focus; `\"gs\"`: phases by the algorithm of Gerchberg and "
              "Saxton, all pistons at full amplitude; `\"wgs\"`: its weighted form, which "
              "makes the foci equally strong"});
    walk(array.frames, {.text = "phase_frames", .in_text = array.frames != nullptr});
    walk(array.reach_m,
         {.key = "reach_mm",
          .range = Range::between(5.0, 500.0),
          .given = Given::by_hand,
          .fallback = "4 FWHM",
          .meaning = "distance from the focus beyond which the side lobes of the pattern are faded "
                     "out, by the factor erfc(8 (r / reach - 1)) / 2"});
    walk_pressure_keys(walk);
}

template <class Walk, Is<LensFootprint> Footprint>
void walk_target(Walk& walk, Footprint& lens) {
    walk(lens.foci_m, {.key = "target_foci_mm",
                       .text = "target_foci_{}_m",
                       .given = Given::by_hand,
                       .type = "points",
                       .fallback = "required, or another target",
                       .meaning = "target: foci `[[x, y], ...]` relative to the axis of the lens"});
    walk(lens.polygon_m, {.key = "target_polygon_mm",
                          .text = "target_polygon_{}_m",
                          .given = Given::by_hand,
                          .type = "points",
                          .fallback = "required, or another target",
                          .meaning = "target: corners of an area of uniform radiation pressure"});
    walk(lens.image, {.key = "target_png",
                      .text = "target_image",
                      .given = Given::by_hand,
                      .type = "file",
                      .fallback = "required, or another target",
                      .meaning = "target: PNG file, relative to the job file, whose grey value is "
                                 "the radiation pressure; its centre is on the axis"});
    walk(lens.image_width_m, {.key = "target_width_mm",
                              .range = Range::between(1.0, 1000.0),
                              .given = Given::by_hand,
                              .fallback = "required with `target_png`",
                              .meaning = "width of the picture along x"});
}

template <class Walk, Is<LensFootprint> Footprint>
void walk_material(Walk& walk, Footprint& lens) {
    walk(lens.material_c_m_s,
         {.key = "material_c_m_s",
          .range = Range::between(50.0, 20000.0),
          .given = Given::required,
          .meaning = "speed of sound in the lens, which determines its thickness; for a plate "
                     "of channels or metamaterial cells, its effective value"});
    walk(lens.material_density_kg_m3,
         {.key = "material_density_kg_m3",
          .range = Range::between(0.1, 30000.0),
          .given = Given::required,
          .meaning = "density of the lens, from which `shearwake lens` computes how much power a "
                     "plate of this material transmits"});
    walk(lens.base_m, {.key = "base_mm",
                       .range = Range::between(0.0, 100.0),
                       .meaning = "least thickness of the lens"});
}

template <class Walk, Is<LensFootprint> Footprint>
void walk_fields(Walk& walk, Footprint& lens) {
    walk(lens.aperture_m, {.key = "aperture_mm",
                           .range = Range::between(5.0, 1000.0),
                           .given = Given::required,
                           .meaning = "diameter of the lens"});
    walk(lens.distance_m, {.key = "distance_mm",
                           .range = Range::between(5.0, 2000.0),
                           .given = Given::required,
                           .meaning = "distance of the lens from the skin"});
    walk_sound_fields(walk, lens);
    walk(lens.absorption_dB_m,
         {.key = "absorption_dB_m",
          .text = "absorption_dB_m",
          .range = Range::between(0.0, 1000.0),
          .given = Given::by_hand,
          .fallback = "by ISO 9613-1, at 25 degrees Celsius and 50 % humidity",
          .meaning = "absorption of the sound in air, in dB per metre"});
    walk(lens.pixel_m,
         {.key = "pixel_mm",
          .range = Range::between(0.1, 50.0),
          .given = Given::by_hand,
          .fallback = "a quarter of the wavelength",
          .meaning = "side of the square pixels of the lens, which have a uniform thickness"});
    walk(lens.phase_levels, {.key = "phase_levels",
                             .range = Range::between(2, 65536),
                             .fallback = "phases are not rounded",
                             .meaning = "number of levels to which the phases are rounded"});
    walk(lens.iterations, {.key = "iterations",
                           .range = Range::between(1, 10000),
                           .meaning = "iterations of the design of the phases"});
    walk_material(walk, lens);
    walk_target(walk, lens);
    walk(lens.reach_m, {.key = "reach_mm",
                        .range = Range::between(5.0, 500.0),
                        .given = Given::by_hand,
                        .fallback = "4 widths of a focus beyond the target",
                        .meaning = "distance from the axis beyond which the pattern is faded out, "
                                   "by the factor erfc(8 (r / reach - 1)) / 2"});
    walk.key({.key = "pressure_Pa",
              .range = Range::above(0.0),
              .type = "number",
              .fallback = "`load.peak_Pa`",
              .meaning = "amplitude of the sound behind the lens; replaces `peak_Pa`"});
    walk.key(
        {.key = "air_density_kg_m3",
         .range = Range::above(0.0),
         .type = "number",
         .fallback = "1.184",
         .meaning = "with `pressure_Pa`: density of air; the default is for 25 degrees Celsius"});
}

/// The ultrasound of a source in air: `frequency_Hz` and `sound_speed_m_s`.
template <class Walk, class Source>
void walk_sound_fields(Walk& walk, Source& source) {
    walk(source.frequency_Hz, {.key = "frequency_kHz",
                               .range = Range::between(10.0, 200.0),
                               .meaning = "frequency of the ultrasound"});
    walk(source.sound_speed_m_s,
         {.key = "sound_speed_m_s",
          .range = Range::between(100.0, 2000.0),
          .meaning = "speed of sound in air; the default is for 25 degrees Celsius"});
}

} // namespace shearwake
