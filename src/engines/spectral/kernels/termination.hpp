// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/slices.hpp"

#include <cmath>

// For kernels only: the end of an absorber. Motion without rotation below it, e^{-az} with
// a^2 = k^2 + s^2/c^2 (c = c_p, s the time derivative), has the impedance
//     pressure / (s W) = rho s/a = rho c T(s/(c k)),    T(x) = x/sqrt(x^2 + 1),
// a dashpot rho c for k = 0, and the added mass rho/k for slow motion. It acts on W at the end of
// the absorber as two oscillators and a dashpot, with coordinates y_i of their own:
//     kinetic energy      rho/2 (dy_i/dt)^2
//     elastic energy      rho c^2 k/2 spring_i (lever_i W - sqrt(k) y_i)^2
//     dissipation         rho c (dW/dt + sqrt(k) sum of share_i dy_i/dt)^2
// No term is negative, so that the termination is passive at any step. The six constants minimise
// the largest reflection (T' - T)/(T' + T): at most 4.6 % up to an angle of incidence of 80
// degrees, where a dashpot alone reflects 17 % at 45 and 70 % at 80 degrees. Fields that decay
// reach the end and return attenuated by e^{-2 a A} in addition, with the depth A of the absorber.

namespace shearwake::spectral {
namespace { // NOLINT(cert-dcl59-cpp): see simd/vector.hpp

struct Oscillator {
    double spring, lever, share;
};
inline constexpr std::ptrdiff_t oscillators = 2;
inline constexpr Oscillator oscillator[oscillators] = {{1.0465, 0.6952, -0.3264},
                                                       {0.7557, -0.3905, 0.6028}};

[[gnu::always_inline]] inline Vector root(Vector k) {
    for (std::ptrdiff_t i = 0; i < width; ++i)
        k[i] = std::sqrt(k[i]);
    return k;
}

} // namespace
} // namespace shearwake::spectral
