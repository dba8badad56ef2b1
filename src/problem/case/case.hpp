// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/afferents.hpp"
#include "problem/case/solver_options.hpp"
#include "problem/case/vibrometer.hpp"
#include "problem/case/volume.hpp"
#include "problem/load/load.hpp"
#include "problem/medium/medium.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// A medium and the load on its surface.
struct Scene {
    Medium medium;
    Load load;
    bool operator==(const Scene&) const = default;
};

/// The surface outside of the domain: copies of it, or an infinite plane that carries no load.
enum class DomainEdges { periodic, open };
constexpr auto names_of(std::type_identity<DomainEdges>) {
    return std::array{"periodic", "open"};
}

/// Rectangle centred on the origin with points x_i = (i - nx/2) spacing and y_j = (j -
/// ny/2) spacing. nx and ny are even products of 2, 3, 5 and 7 of at least extent / spacing.
struct Domain {
    std::ptrdiff_t nx = 0;
    std::ptrdiff_t ny = 0;
    double spacing_m = 0.0;
    double sponge_m = 0.0; // width of the margin on each side that is excluded from the measures
    DomainEdges edges = DomainEdges::periodic;
    bool operator==(const Domain&) const = default;

    double extent_x_m() const { return static_cast<double>(nx) * spacing_m; }
    double extent_y_m() const { return static_cast<double>(ny) * spacing_m; }
    double x_m(std::ptrdiff_t i) const { return static_cast<double>(i - nx / 2) * spacing_m; }
    double y_m(std::ptrdiff_t j) const { return static_cast<double>(j - ny / 2) * spacing_m; }
    bool contains(Vec2 at_m) const {
        return std::abs(at_m.x) <= 0.5 * extent_x_m() && std::abs(at_m.y) <= 0.5 * extent_y_m();
    }
};

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

/// The load begins at t = 0, when nothing has moved; or it has always repeated.
enum class Regime { transient, periodic };
constexpr auto names_of(std::type_identity<Regime>) {
    return std::array{"transient", "periodic"};
}

/// Frames are at t = interval, 2 interval, ..., frames interval. In the periodic regime they cover
/// one period, and the last one is also the one at t = 0.
struct TimeAxis {
    std::ptrdiff_t frames = 0;
    double interval_s = 0.0;
    Regime regime = Regime::transient;
    bool operator==(const TimeAxis&) const = default;

    double duration_s() const { return static_cast<double>(frames) * interval_s; }
    double frame_s(std::ptrdiff_t n) const { return static_cast<double>(n + 1) * interval_s; }
};

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

struct FrequencyBand {
    double low_Hz = 0.0, high_Hz = 0.0;
    bool operator==(const FrequencyBand&) const = default;
};

/// The weight of the frames in the `_period_` columns.
enum class PeriodWeight { whole_periods, sliding };
constexpr auto names_of(std::type_identity<PeriodWeight>) {
    return std::array{"whole-periods", "sliding"};
}

/// Whether the level of sensation is computed: in the periodic regime, always or never.
enum class Sensation { by_regime, on, off };
constexpr auto names_of(std::type_identity<Sensation>) {
    return std::array{"by-regime", "on", "off"};
}

/// Position and time of the measurements.
struct MeasureOptions {
    double at_s = 0.0; // the instant, and the end of the window of the `_period_` columns
    double settled_after_s = 0.0; // the window begins no earlier than this
    PeriodWeight window = PeriodWeight::whole_periods;
    double focal_radius_m = 0.0;
    std::vector<double> depths_m = {0.0};
    std::vector<FrequencyBand>
        bands;                  // each gives a column with its share of the energy at the centre
    std::vector<Vec2> region_m; // corners of the measured polygon; none: all inside the sponge
    Sensation sensation = Sensation::by_regime;
    bool operator==(const MeasureOptions&) const = default;
};

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

/// How the level of sensation is computed (measures/sensation.hpp).
struct SensationOptions {
    /// Centre [Hz] and threshold [m/s^2 rms] of consecutive third octaves; none: the built-in
    /// table.
    std::vector<Vec2> threshold;
    std::vector<Vec2>
        line_m; // start and end of the line on which maxima are counted; none: default
    bool operator==(const SensationOptions&) const = default;
};

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

/// All parameters of one simulation in SI units, as a comparable value.
struct Case {
    Scene scene;
    Domain domain;
    TimeAxis time;
    MeasureOptions measure;
    RecordOptions record;
    SolverOptions solver;
    std::optional<AfferentOptions> afferents; // none: no afferents are simulated
    std::optional<VibrometerOptions> vibrometer = std::nullopt;
    std::optional<SensationOptions> sensation = std::nullopt; // none: the defaults
    bool operator==(const Case&) const = default;
};

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

/// Whether the level of sensation is computed.
inline bool computes_sensation(const Case& c) {
    return c.measure.sensation == Sensation::on ||
           (c.measure.sensation == Sensation::by_regime && c.time.regime == Regime::periodic);
}

/// The depths of the receptors at which a case requests the stress, ascending; empty if it does
/// not.
std::vector<double> stress_depths_m(const Case& c);

/// Whether a case requests the tangential displacement of the surface.
bool wants_tangential(const Case& c);

/// The engine's name in job files and tables.
std::string engine_name(const SolverOptions& solver);
/// The names of all engines, in the order of the variant.
std::vector<std::string> engine_names();

/// The smallest even product of 2, 3, 5 and 7 that is at least `n`, a length with fast FFTs.
std::ptrdiff_t good_even_length(std::ptrdiff_t n);

/// The complete case as TOML in SI units, with defaults, exact numbers and a fixed order of keys.
/// Two cases have the same text if and only if they are equal.
std::string canonical_text(const Case& c);

/// How many numbers of long lists the canonical text represents by hashes.
double hashed_numbers(const Case& c);

/// Sixteen hexadecimal digits: the hash of the canonical text.
std::string case_id(const Case& c);
/// The id, with another first digit if it consists of digits and at most one e, which programs that
/// read tables would take as a number.
std::string avoid_numeric_id(std::string id);

} // namespace shearwake
