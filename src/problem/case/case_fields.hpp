// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "problem/case/case.hpp"
#include "problem/case/receptor_fields.hpp"
#include "problem/load/load_fields.hpp"
#include "problem/medium/medium_fields.hpp"

namespace shearwake {

// The descriptions of the options of a case, see base/field.hpp. They are apart from the structs,
// since only those who read, write or list keys need them.

template <class Walk, Is<RecordOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk.section("record");
    walk(o.traces_m, {.key = "traces_mm",
                      .text = "traces_{}_m",
                      .given = Given::by_hand,
                      .fallback = "[[0, 0]]",
                      .meaning = "points whose u_z(t) and spectrum are stored"});
    walk(o.snapshots_s, {.key = "snapshots_ms",
                         .range = Range::above(0.0),
                         .given = Given::by_hand,
                         .fallback = "[`at_ms`]",
                         .meaning = "times at which the surface is stored"});
    walk(o.frames,
         {.key = "frames", .meaning = "store every frame, with an .xdmf file for ParaView"});
    walk(o.volumes_s, {.key = "volumes_ms",
                       .range = Range::above(0.0),
                       .given = Given::by_hand,
                       .in_text = !o.volumes_s.empty(),
                       .fallback = "none",
                       .meaning = "times at which the whole volume is stored, with an .xdmf file "
                                  "for ParaView; engines `spectral` and `pstd`"});
    walk(o.volume_fields, {.key = "volume_fields",
                           .given = Given::by_hand,
                           .applies = !o.volumes_s.empty(),
                           .only_with = "volumes_ms",
                           .fallback = "[\"u\"]",
                           .meaning = "fields that are stored at these times (`pstd`: only "
                                      "`\"u\"`), see [case-files.md](case-files.md)",
                           .least_count = 1});
}

template <class Walk, Is<Domain> D>
void walk_fields(Walk& walk, D& domain) {
    walk.section("domain");
    walk.key(
        {.key = "extent_mm",
         .range = Range::above(0.0),
         .given = Given::required,
         .type = "point",
         .meaning =
             "width along x and y; enlarged to the next grid size with fast FFTs. Periodic edges: "
             "choose it so large that no wave returns (`check` reports how large)"});
    walk(domain.nx, {.text = "nx"});
    walk(domain.ny, {.text = "ny"});
    walk(domain.spacing_m, {.key = "spacing_mm",
                            .range = Range::above(0.0),
                            .given = Given::required,
                            .meaning = "grid spacing"});
    walk(domain.sponge_m,
         {.key = "sponge_mm",
          .range = Range::at_least(0.0),
          .meaning =
              "margin on each side that is excluded from the measures. Engine `\"spectral\"`: it "
              "absorbs waves that leave the domain, which can then be smaller; a width of four "
              "FWHM absorbs 99 % of the energy of the longest waves of the footprint at normal "
              "incidence. To absorb 99 % of the energy of a pulse in all directions, about 7 FWHM "
              "are needed at a viscosity of up to 0.1 Pa s, and 9 FWHM at 0.5 Pa s (`check` "
              "reports the energy that returns; see "
              "[edges](../explanation/engine-spectral.md#edges)). Engine `\"pstd\"`: width of its "
              "absorbing layer"});
    walk(domain.edges,
         {.key = "edges",
          .in_text = domain.edges != DomainEdges::periodic,
          .meaning =
              "`\"periodic\"`: waves that leave through one edge return through the opposite "
              "one; `\"open\"` (engine `\"layered\"`): the field on an infinite plane, so "
              "that the domain need only contain what is measured"});
}

template <class Walk, Is<TimeAxis> T>
void walk_fields(Walk& walk, T& time) {
    walk.section("time");
    walk(time.regime,
         {.key = "regime",
          .in_text = time.regime != Regime::transient,
          .meaning = "`\"transient\"`: the load begins at t = 0; `\"periodic\"` (engine "
                     "`\"layered\"`): the steady state of a load that has always repeated. The "
                     "frames then cover one period"});
    walk.key({.key = "duration_ms",
              .range = Range::above(0.0),
              .type = "number",
              .fallback = "required; not used with `regime = \"periodic\"`",
              .meaning = "simulated time, a whole number of output intervals"});
    walk.key({.key = "longest_period_ms",
              .range = Range::above(0.0),
              .type = "number",
              .fallback = "1000",
              .meaning = "with `regime = \"periodic\"`: longest common period of the load's "
                         "frequencies that is accepted"});
    walk(time.frames, {.text = "frames"});
    walk(time.interval_s,
         {.key = "output_interval_us",
          .text = "interval_s",
          .range = Range::above(0.0),
          .given = Given::required,
          .meaning =
              "time between the frames from which the measures are computed. In the periodic "
              "regime it is reduced, so that a period has an even number of frames"});
}

template <class Walk, class Options>
void walk_region(Walk& walk, Options& o) {
    walk.key({.key = "region_mm",
              .range = Range::above(0.0),
              .type = "point or word:path|palm",
              .fallback = "everything inside the sponge; `\"path\"` in the periodic regime",
              .meaning =
                  "part of the surface in which eta, the participation ratios, the peak and "
                  "the sharpness are measured: the size `[x, y]` of a rectangle, `\"path\"` "
                  "(the bounding box of the path and of the foci, 30 mm wider on each side), "
                  "or `\"palm\"` (the outline of the palm of the hand on which "
                  "`afferents.patch_mm` places the domain). Samples on its edge count with the "
                  "fraction of their cell inside"});
    walk.key({.key = "region_center_mm",
              .type = "point",
              .fallback = "[0, 0]",
              .meaning = "centre of a rectangle given by `region_mm`"});
    walk(o.region_m, {.text = "region_{}_m", .in_text = !o.region_m.empty()});
}

template <class Walk, Is<MeasureOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk.section("measure");
    walk(o.at_s, {.key = "at_ms",
                  .range = Range::above(0.0),
                  .given = Given::by_hand,
                  .fallback = "the end of the run",
                  .meaning = "the instant of the `_at_` columns, and the end of the window of the "
                             "`_period_` columns"});
    walk(o.settled_after_s,
         {.key = "settled_after_ms",
          .range = Range::at_least(0.0),
          .given = Given::by_hand,
          .fallback = "a quarter of `at_ms`",
          .meaning = "the window of the `_period_` columns begins no earlier than this"});
    walk(o.window,
         {.key = "window",
          .in_text = o.window != PeriodWeight::whole_periods,
          .meaning = "`\"whole-periods\"`: the window of the `_period_` columns is the largest "
                     "number of whole modulation periods before `at_ms`, so the columns jump "
                     "where another period fits; `\"sliding\"`: the mean over all windows of one "
                     "period between `settled_after_ms` and `at_ms`, so the columns are "
                     "continuous functions of the modulation frequency"});
    walk(o.focal_radius_m, {.key = "focal_radius_mm",
                            .range = Range::above(0.0),
                            .given = Given::by_hand,
                            .fallback = "1 FWHM",
                            .meaning = "radius of the focal disc; or `focal_radius_fwhm`"});
    walk.key({.key = "focal_radius_fwhm",
              .range = Range::above(0.0),
              .type = "number",
              .fallback = "1",
              .meaning =
                  "instead of `focal_radius_mm`: the radius divided by the FWHM of the footprint"});
    walk(o.depths_m, {.key = "depths_mm",
                      .range = Range::at_least(0.0),
                      .meaning = "depths at which u_z is computed",
                      .least_count = 1});
    walk(o.bands, {.key = "bands_Hz",
                   .given = Given::by_hand,
                   .in_text = !o.bands.empty(),
                   .type = "points",
                   .fallback = "none",
                   .meaning = "frequency bands `[[low, high], ...]`. For each band the table has a "
                              "column with the fraction of the spectral energy at the centre that "
                              "lies in the band; frequencies up to 1/duration are left out"});
    walk_region(walk, o);
    walk.key({.key = "sensation",
              .type = "boolean",
              .fallback = "true in the periodic regime, otherwise false",
              .meaning = "compute the level of the motion of the skin above the threshold of "
                         "perception: the `felt_` columns, and a map in the case file"});
    walk(o.sensation, {.text = "sensation", .in_text = o.sensation != Sensation::by_regime});
}

template <class Walk, Is<SensationOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk.key({.key = "threshold",
              .type = "file",
              .fallback = "a handle that the hand grips, "
                          "[sources](table-columns.md#level-of-sensation)",
              .meaning = "CSV file with the header `frequency_Hz,acceleration_m_s2`: one line for "
                         "each third octave without gaps, with its nominal centre and the rms "
                         "acceleration at the threshold there; its path is relative to the job "
                         "file"});
    walk(o.threshold, {.text = "threshold_{}", .in_text = !o.threshold.empty()});
    walk(o.line_m, {.key = "line_mm",
                    .text = "line_{}_m",
                    .given = Given::by_hand,
                    .in_text = !o.line_m.empty(),
                    .fallback = "from one focus to the other, one FWHM longer at both ends, if two "
                                "or more foci rest",
                    .meaning = "start and end `[[x, y], [x, y]]` of the line on which the maxima "
                               "of the level are counted"});
}

template <class Walk, Is<Case> C>
void walk_fields(Walk& walk, C& c) {
    walk_fields(walk, c.scene.medium);
    walk_fields(walk, c.scene.load);
    walk_fields(walk, c.domain);
    walk_fields(walk, c.time);
    walk_fields(walk, c.measure);
    walk_fields(walk, c.record);
    walk.section("solver");
    walk.choice(
        c.solver,
        {.key = "engine",
         .text = "engine",
         .own_tables = true,
         .meaning =
             "`\"layered\"`: exact for layered media; `\"spectral\"`: time stepping for layers, "
             "bodies and maps, Kelvin-Voigt or lossless; `\"pstd\"`: the scheme of k-Wave for the "
             "same media, with Gaussian foci and c_p limited to a multiple of c_s. The options are "
             "in `[solver.layered]`, `[solver.spectral]` and `[solver.pstd]`; those of the other "
             "engines are checked and otherwise ignored, so that a sweep can compare engines"});
    walk.maybe("afferents", c.afferents);
    walk.maybe("vibrometer", c.vibrometer);
    walk.maybe("sensation", c.sensation);
}

} // namespace shearwake
