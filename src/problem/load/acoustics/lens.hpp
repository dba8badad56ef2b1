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
