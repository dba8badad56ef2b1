// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"
#include "problem/load/acoustics/hologram.hpp"
#include "problem/load/acoustics/lens.hpp"
#include "problem/load/acoustics/patch.hpp"

#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

struct Modulation;

/// Unit-peak Gaussian of radiation pressure; sigma = FWHM / (2 sqrt(2 ln 2)).
struct GaussianFootprint {
    static constexpr const char* name = "gaussian";
    double fwhm_m = 0.0;
    bool operator==(const GaussianFootprint&) const = default;
};

/// Phases of the pistons of an array for some time, all at full amplitude. The place of its largest
/// pressure, different for each frame, is the focus of the load meanwhile, and selects the frame.
struct PhaseFrame {
    Vec2 place_m;
    std::vector<std::complex<double>> drives;
};
struct PhaseFrames {
    std::vector<PhaseFrame> all;
    std::string content_hash;
};

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
    std::shared_ptr<const PhaseFrames> frames; // instead of a hologram
    bool operator==(const ArrayFootprint&) const = default;
};

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
