// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "problem/load/acoustics/lens.hpp"
#include "problem/load/acoustics/patch.hpp"

#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace shearwake {

/// Absorption of sound in air by ISO 9613-1 [dB/m] at this frequency, absolute temperature and
/// relative humidity (0 to 1), at 101.325 kPa.
double air_absorption_dB_m(double frequency_Hz, double temperature_K, double humidity);

/// Sound of one frequency in air.
struct Sound {
    double wavenumber_rad_m = 0.0;
    double attenuation_Np_m = 0.0; // of the pressure
};

/// Two parallel planes with the same square lattice of side x side points.
struct PlanePair {
    std::ptrdiff_t side = 0;
    double spacing_m = 0.0; // at most a quarter of the wavelength and half the distance
    double distance_m = 0.0;
};

/// The pressure e^{-i w t} of square cells of uniform pressure, at the points of another plane: the
/// Rayleigh-Sommerfeld integral of the first kind, (1 / 2 pi) integral of p z / r^2 (1 / r - i k)
/// e^{i k r}, over each cell. The sum over the cells is a periodic convolution by FFT. It is that
/// of the open plane where the offset between a cell and a point is at most half a side along each
/// axis. Not collective.
class PlanePropagation {
public:
    PlanePropagation(const Sound& sound, const PlanePair& planes);
    ~PlanePropagation();
    PlanePropagation(PlanePropagation&&) noexcept;
    PlanePropagation& operator=(PlanePropagation&&) noexcept;

    /// The pressure on the other plane, in place; y fastest.
    void forward(std::span<std::complex<double>> pressure);
    /// The adjoint of `forward`: propagation back, without amplification of what was absorbed.
    void adjoint(std::span<std::complex<double>> pressure);

private:
    struct Transforms;
    enum class Direction { forward, backward };
    void apply(std::span<std::complex<double>> pressure, Direction direction);

    std::ptrdiff_t side_;
    std::unique_ptr<Transforms> transforms_;
    std::vector<std::complex<double>> factors_; // (kx, ky), symmetric
};

/// The band-limited samples on a lattice that is `factor` times as fine. Not collective.
std::vector<double> refined(std::span<const double> samples, std::ptrdiff_t side,
                            std::ptrdiff_t factor);

/// The phases of a lens and its field on the skin.
struct LensDesign {
    std::ptrdiff_t pixels = 0;     // along each side of the square around the aperture
    std::vector<double> phase_rad; // of pixel (i, j), y fastest; NaN outside the aperture
    Patch pattern;                 // |p|^2 on the skin divided by its peak, faded out
    double width_m = 0.0;          // equivalent diameter of the spot around the peak, where |p|^2
                                   // is above a half
    double gain = 0.0;             // peak pressure on the skin per pressure at the lens
    double efficiency = 0.0;       // power that arrives where the target exceeds a half, divided
                                   // by the power that leaves the lens
    double uniformity = 1.0;       // 1 - (max - min) / (max + min) of |p|^2 at the foci
    /// After each iteration, and finally after the rounding of the phases: 1 - (sum |p|
    /// |p_target|)^2 / (sum |p_target|^2 P) with the power P behind the lens, the fraction of the
    /// power that does not arrive with the amplitude of the target.
    std::vector<double> errors;
};

/// Computes the phases by the iterative algorithm of Melde et al. (Nature 537, 518, 2016), with the
/// propagation of square pixels: propagation to the skin, replacement of the amplitude by that of
/// the target, propagation back, and replacement of the amplitude by that of the lens. The way back
/// is the adjoint of the way there: each iteration then maximises a linear lower bound of the
/// convex function sum |p| |p_target|, so that the error decreases. Deterministic. Not collective.
LensDesign design_lens(const LensFootprint& lens);

/// The pressure on the skin for these phases of the pixels and unit amplitude at the lens, on the
/// lattice of the lens; y fastest. Valid up to fading_end_m() from the axis.
std::vector<std::complex<double>> field_on_skin(const LensFootprint& lens,
                                                const std::vector<double>& phase_rad);

/// The design of a lens: the one that it carries, or a new one.
std::shared_ptr<const LensDesign> design_of(const LensFootprint& lens);

/// Designs that have been computed, so that the cases of a sweep share them.
class LensDesigns {
public:
    std::shared_ptr<const LensDesign> of(const LensFootprint& lens);

private:
    std::vector<LensFootprint> known_;
};

/// Columns of square cross-section on a plane: heights (i, j), y fastest; 0 or less: no column.
struct HeightMap {
    std::ptrdiff_t side = 0;
    double pixel_m = 0.0;
    std::vector<double> heights_m;
};

using Triangle = std::array<Vec3, 3>;

/// The surface of the columns, centred on the z axis, from z = 0 upwards; the corners of each
/// triangle are counterclockwise as seen from outside [m]. Closed: each edge occurs equally often
/// in both directions.
std::vector<Triangle> surface_of(const HeightMap& map);

/// A binary STL file in millimetres.
std::string binary_stl(const std::vector<Triangle>& triangles);

} // namespace shearwake
