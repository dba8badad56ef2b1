// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/case.hpp"

namespace shearwake::spectral {

/// Bottom of a half-space: a clear part of the last layer, below it an absorber of the same
/// material on a rigid base. Shear waves are absorbed by a viscosity that acts on curl v alone. The
/// potential flow of nearly incompressible tissue, e^{-kz} for every k of the domain, must not be
/// disturbed; therefore the absorber, which consists of a few long elements, is nearly as deep as
/// the domain is wide. A drag or an ordinary viscosity in its place impeded this flow: the error of
/// the surface field at 14 ms was 3 to 15 % instead of 0.4 %.
struct AbsorbingBottom {
    double clear_m = 0.0;   // clear part of the last layer
    double depth_m = 0.0;   // of the absorber
    double longest_m = 0.0; // longest shear wavelength that it is designed for
};

/// Chooses the absorber. The clear part contains half of the longest wave, all measured depths and
/// inclusions, and in addition one focus width. Not collective.
AbsorbingBottom absorbing_bottom(const Case& c, const SpectralOptions& options);

/// Viscosity [Pa s] that acts on curl v at the distance `into_m` below the top of the absorber,
///     14/(k A)^2 rho c s^2/A,
/// with its depth A and the wavenumber k of the longest wave. A wave keeps 1 % of its amplitude on
/// the way to the base and back.
double swirl_viscosity_Pa_s(const AbsorbingBottom& bottom, const Layer& layer, double into_m);

} // namespace shearwake::spectral
