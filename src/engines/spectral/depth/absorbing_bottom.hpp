// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

namespace shearwake::spectral {

/// Bottom of a half-space: a clear part of the last layer, below it an absorber of the same
/// material, which ends in the impedance of the half-space for motion without rotation
/// (kernels/termination.hpp). Shear waves are absorbed by a viscosity that acts on curl v alone. It
/// does not disturb compressional waves and the potential flow of nearly incompressible tissue,
/// which reach the end. The absorber, which consists of a few long elements, is nearly as deep as
/// the domain is wide, because slow motion, which decays as e^{-kz}, contains rotation too.
struct AbsorbingBottom {
    double clear_m = 0.0;   // clear part of the last layer
    double depth_m = 0.0;   // of the absorber
    double longest_m = 0.0; // longest shear wavelength that it is designed for
};

/// Chooses the absorber. The clear part contains half of the longest wave, all measured depths and
/// inclusions, and in addition one focus width. Not collective.
AbsorbingBottom absorbing_bottom(const Case& c, const SpectralOptions& options);

/// Viscosity [Pa s] that acts on curl v at the distance `into_m` below the top of the absorber,
///     45/(k A)^2 rho c A (s/A)^4,
/// with its depth A and the wavenumber k of the longest wave. A wave keeps e^{-45/5} = 1e-4 of its
/// amplitude on the way to the end and back.
double swirl_viscosity_Pa_s(const AbsorbingBottom& bottom, const Layer& layer, double into_m);

} // namespace shearwake::spectral
