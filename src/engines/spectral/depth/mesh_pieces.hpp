// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

#include <limits>
#include <vector>

namespace shearwake::spectral {

/// Minimum number of elements over the height of a curved body. Relative error of the surface field
/// (3 mm focus at 7 m/s over 12 mm, compared with elements of 0.5 mm): for an ellipsoid of 12 x 10
/// x 3 mm that is 16 times stiffer 1.3, 0.5, 0.3 and 0.15 % with 1, 2, 3 and 4 elements; if it is a
/// quarter as stiff 0.9 and 0.08 % with 1 and 4; for a cylinder of 8 mm that is 400 times stiffer
/// 3.1 and 1.9 %. Without element boundaries at its top and bottom the error for the first
/// ellipsoid is 50 %.
constexpr double elements_of_body = 2.0;

/// A part of a layer with a common limit on the length of its elements.
struct MeshPiece {
    std::size_t layer = 0;
    double top_m = 0.0, bottom_m = 0.0;
    double longest_m =
        std::numeric_limits<double>::infinity(); // of an element, set by the inclusions
    bool has_light_body = false;                 // a free rigid body, lighter than the layer
};

/// Divides the layers down to `depth_m` at the tops and bottoms of bodies and the map, where the
/// moduli jump and the motion has a kink that no polynomial resolves. Depths closer together than
/// `least_m` are merged. Element lengths are limited to half of a curved body and seven spacings,
/// the edge width of a smooth body, eight points of a map, or twenty times the inverse wavenumber
/// of shear waves at `omega_rad_s` in a body. Not collective.
std::vector<MeshPiece> mesh_pieces(const Case& c, double depth_m, double least_m, int degree,
                                   double omega_rad_s);

/// Bottom of a half-space: a clear part of the last layer, below it an absorber of the same
/// material, which ends in the impedance of the half-space for motion without rotation
/// (kernels/slices.hpp). Shear waves are absorbed by a viscosity that acts on curl v alone. It
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
