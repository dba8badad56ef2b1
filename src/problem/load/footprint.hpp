// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"
#include "problem/load/acoustics/hologram.hpp"
#include "problem/load/acoustics/lens.hpp"
#include "problem/load/acoustics/patch.hpp"
#include "problem/load/modulation.hpp"

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

namespace shearwake {

/// Unit-peak Gaussian of radiation pressure; sigma = FWHM / (2 sqrt(2 ln 2)).
struct GaussianFootprint {
    static constexpr const char* name = "gaussian";
    double fwhm_m = 0.0;
    bool operator==(const GaussianFootprint&) const = default;
};

template <class Walk, Is<GaussianFootprint> Footprint>
void walk_fields(Walk& walk, Footprint& f) {
    walk(f.fwhm_m, {.key = "fwhm_mm",
                    .range = Range::between(0.01, 1000.0),
                    .given = Given::required,
                    .meaning = "full width at half maximum"});
}

/// The radiation pressure of a flat array of ultrasonic pistons that is parallel to the skin and
/// focused on it: the square of the pressure amplitude, divided by its peak when the array focuses
/// directly below its centre. Pistons are on a regular grid, except the `missing` ones.
struct ArrayFootprint {
    static constexpr const char* name = "array";
    std::ptrdiff_t columns = 16, rows = 16; // along x and y
    double pitch_m = 10.47e-3;
    double radius_m = 4.5e-3; // of a piston
    double distance_m = 0.2;  // from the skin
    Vec2 center_m;            // the point of the skin below the array's middle
    double frequency_Hz = 40e3;
    double sound_speed_m_s = 346.1;      // air of 25 degrees
    std::vector<std::ptrdiff_t> missing; // column + row * columns
    int phase_levels = 0;                // phase levels of each piston; 0: not rounded
    double update_rate_Hz = 0.0;         // update rate of the focus; 0: continuous
    double reach_m = 0.0;                // distance from the focus of the fade-out, see ArrayField
    Hologram hologram = Hologram::superposition;
    bool operator==(const ArrayFootprint&) const = default;
};

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
    walk(array.reach_m,
         {.key = "reach_mm",
          .range = Range::between(5.0, 500.0),
          .given = Given::by_hand,
          .fallback = "4 FWHM",
          .meaning = "distance from the focus beyond which the side lobes of the pattern are faded "
                     "out, by the factor erfc(8 (r / reach - 1)) / 2"});
    walk_pressure_keys(walk);
}

using Footprint = std::variant<GaussianFootprint, ArrayFootprint, LensFootprint>;

// For an array, these four functions describe the pattern of a focus directly below its centre;
// LoadPattern describes how it changes with the position of the focus. For a lens, they describe
// its static pattern, relative to its axis.

/// Pressure at (x, y) from the focus, divided by the peak.
double pressure(const Footprint& footprint, double x_m, double y_m);
/// Its two-dimensional Fourier transform, integral of pressure e^{-i k.x} dx dy [m^2]; for arrays
/// and lenses its modulus.
double spectrum(const Footprint& footprint, double kx_rad_m, double ky_rad_m);
/// Full width at half maximum [m]; for an array the geometric mean of those along x and y, for a
/// lens that of the spot around the peak.
double fwhm_m(const Footprint& footprint);
/// The distance from the focus beyond which the pattern is faded out, see fading(); none for a
/// Gaussian [m].
std::optional<double> reach_m(const Footprint& footprint);
/// The rate at which the source updates the position of its focus; 0: continuously [Hz].
double update_rate_Hz(const Footprint& footprint);
/// The |k| beyond which the spectrum stays below `fraction` of its largest value [rad/m].
double bandwidth_rad_m(const Footprint& footprint, double fraction);

/// The shape that a modulation is intended to draw, as lines of points at most `step_m` apart,
/// including corners: the path of its first part that moves along one (for STP the path of the
/// centre, not the pattern), displaced by the parts that rest. Without a path, the line of its
/// first swing; if all parts rest, a single point. One line per focus.
std::vector<std::vector<Vec2>> drawn_shape(const Modulation& modulation, double step_m);

} // namespace shearwake
