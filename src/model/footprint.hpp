#pragma once

#include "base/vec2.hpp"

#include <cstddef>
#include <variant>
#include <vector>

namespace shearwake {

/// Unit-peak Gaussian of radiation pressure; sigma = FWHM / (2 sqrt(2 ln 2)).
struct GaussianFootprint {
    double fwhm_m = 0.0;
    bool operator==(const GaussianFootprint&) const = default;
};

/// The radiation pressure of a flat array of ultrasonic pistons, which is parallel to the skin and
/// focused on it: the square of the pressure amplitude, over its peak where the array focuses
/// straight below its middle. Pistons stand on a regular grid, but for the `missing`.
struct ArrayFootprint {
    std::ptrdiff_t columns = 16, rows = 16; // along x and y
    double pitch_m = 10.47e-3;
    double radius_m = 4.5e-3; // of a piston
    double distance_m = 0.2;  // from the skin
    Vec2 center_m;            // the point of the skin below the array's middle
    double frequency_Hz = 40e3;
    double sound_speed_m_s = 346.1;      // air of 25 degrees
    std::vector<std::ptrdiff_t> missing; // column + row * columns
    int phase_levels = 0;                // of each piston's drive; 0: any phase
    double update_rate_Hz = 0.0;         // the focus is set so often; 0: always
    double reach_m = 0.0; // the pattern is faded out about this far from its focus, see ArrayField
    bool operator==(const ArrayFootprint&) const = default;
};

using Footprint = std::variant<GaussianFootprint, ArrayFootprint>;

// Of an array these four tell of the pattern where it focuses straight below its middle; how it
// changes on the way is in LoadPattern.

/// Pressure over the peak at distance (x, y) from the focus.
double pressure(const Footprint& footprint, double x_m, double y_m);
/// Its two-dimensional Fourier transform, integral of pressure e^{-i k.x} dx dy [m^2]; of an
/// array its modulus.
double spectrum(const Footprint& footprint, double kx_rad_m, double ky_rad_m);
/// Full width at half maximum [m]; of an array the geometric mean of those along x and y.
double fwhm_m(const Footprint& footprint);
/// The |k| beyond which the spectrum stays below `fraction` of its largest value [rad/m].
double bandwidth_rad_m(const Footprint& footprint, double fraction);

} // namespace shearwake
