// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "problem/load/acoustics/hologram.hpp"
#include "problem/load/acoustics/patch.hpp"

#include <memory>

namespace shearwake {

struct LensDesign;

/// A plane phase plate (an acoustic hologram) parallel to the skin, in a plane wave of uniform
/// amplitude, and the radiation pressure on the skin that it produces: the square of the pressure
/// amplitude, divided by its peak. The pattern is static. Its centre is the position of the focus
/// in the modulation.
struct LensFootprint {
    static constexpr const char* name = "lens";
    double aperture_m = 0.0; // diameter
    double distance_m = 0.2; // from the skin
    double frequency_Hz = 40e3;
    double sound_speed_m_s = 346.1; // air of 25 degrees
    double absorption_dB_m = 0.0;
    double pixel_m = 0.0;
    int phase_levels = 0; // phase levels of a pixel; 0: not rounded
    int iterations = 100;
    double material_c_m_s = 0.0;              // speed of sound in the lens
    double material_density_kg_m3 = 0.0;      // of the lens
    double base_m = 1e-3;                     // least thickness
    std::vector<Vec2> foci_m;                 // the target: foci,
    std::vector<Vec2> polygon_m;              // or the corners of an area,
    std::shared_ptr<const TargetImage> image; // or a picture
    double image_width_m = 0.0;
    double reach_m = 0.0; // distance from the axis of the fade-out, see fading()

    /// Derived from the other fields, if it has been computed.
    std::shared_ptr<const LensDesign> design;

    bool operator==(const LensFootprint& other) const;
};

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

/// Wavelength in air [m].
double wavelength_m(const LensFootprint& lens);
/// The width (FWHM) of |p|^2 of a focus on the axis of a lens of this aperture, 0.51 lambda / sin
/// alpha with the half angle alpha of the aperture [m].
double focal_width_m(const LensFootprint& lens);
/// Distance from the axis of the outermost point of the target [m].
double target_extent_m(const LensFootprint& lens);
/// The requested radiation pressure at a point of the skin, relative to its peak.
double target_pressure(const LensFootprint& lens, Vec2 at_m);
/// Points along each side of the lattice on which the lens is computed, and their spacing: an
/// integer number of points per pixel, at least four per wavelength. The centre of a pixel is on
/// the axis.
struct LensLattice {
    std::ptrdiff_t points_per_pixel = 1, side = 0;
    double spacing_m = 0.0;
    /// Coordinate of a point.
    double at_m(std::ptrdiff_t i) const {
        return (static_cast<double>(i) - 0.5 * static_cast<double>(side - 1)) * spacing_m;
    }
};
LensLattice lattice(const LensFootprint& lens);
/// Pixels along each side of the square around the aperture, an odd number.
std::ptrdiff_t pixels_along(const LensFootprint& lens);
/// Thickness that delays or advances the sound by this phase (in [0, 2 pi)) relative to the base
/// thickness [m].
double thickness_m(const LensFootprint& lens, double phase_rad);
/// Fraction of the power that a plate of this thickness transmits at normal incidence.
double transmission(const LensFootprint& lens, double thickness_m);

} // namespace shearwake
