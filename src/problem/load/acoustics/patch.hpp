// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace shearwake {

/// Samples on a square lattice: value (i, j) at origin + (i, j) spacing, y fastest.
struct Patch {
    Vec2 origin_m;
    double spacing_m = 0.0;
    std::ptrdiff_t side = 0; // samples along each axis
    std::vector<double> values;

    /// The largest |k| that the samples represent along each axis.
    double band_rad_m() const;
};

/// For each column i of the patch, the sum over j of values e^{-i ky (j spacing)}.
void transform_columns(const Patch& patch, double ky_rad_m, std::span<std::complex<double>> out);
/// spacing^2 times the sum over those columns with e^{-i kx (i spacing)}: the Fourier transform of
/// the patch relative to its origin [m^2].
std::complex<double> transform_row(const Patch& patch, double kx_rad_m,
                                   std::span<const std::complex<double>> columns);
/// The Fourier transform of the patch relative to its origin [m^2]; 0 beyond its band.
std::complex<double> transform(const Patch& patch, double kx_rad_m, double ky_rad_m);

/// The band-limited function with these samples.
double value_at(const Patch& patch, Vec2 at_m);

/// The factor that fades a pattern out around the distance `reach_m` from its centre: erfc((r -
/// reach) / (reach / 8)) / 2.
double fading(double reach_m, double r_m);
/// The distance beyond which that factor is below 1e-9.
double fading_end_m(double reach_m);

} // namespace shearwake
