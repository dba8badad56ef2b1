#pragma once

#include "model/case.hpp"

namespace shearwake {

/// How a half-space ends: below a clear piece of it comes an absorber of the same material, on a
/// rigid base. Two things reach down: shear waves, which a viscosity against swirl takes (it acts
/// on curl v alone), and the potential flow of nearly incompressible tissue, e^{-kz} for every k
/// that the domain holds, which nothing may disturb; so the absorber is nearly as deep as the
/// domain is wide, in a few long elements. With a drag or a viscosity in its place the flow was
/// held back: 3 to 15 % of the surface field at 14 ms where now 0.4 % are seen.
struct AbsorbingBottom {
    double clear_m = 0.0;   // of the last layer
    double depth_m = 0.0;   // of the absorber
    double longest_m = 0.0; // wavelength that it is made for
};

/// Clear are half the longest wave, whatever is measured or lies in the medium, and a focus more.
AbsorbingBottom absorbing_bottom(const Case& c, const SpectralOptions& options);

/// The viscosity against swirl that far into the absorber,
///     14/(k A)^2 rho c s^2/A,
/// A its depth and k of the longest wave: on its way to the base and back a wave is left with 1 %
/// of its amplitude.
double swirl_viscosity_Pa_s(const AbsorbingBottom& bottom, const Layer& layer, double into_m);

} // namespace shearwake
