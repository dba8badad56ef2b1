// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/skyline.hpp"
#include "simd/vector.hpp"

#include <cmath>

// For kernels only: access to blocks by vectors. A slice is the part of a block that fits into one
// vector.

namespace shearwake::spectral {
namespace { // NOLINT(cert-dcl59-cpp): see simd/vector.hpp

using simd::Vector;
using simd::width;

inline constexpr std::ptrdiff_t slices = lane_count / width;

[[gnu::always_inline]] inline Vector get(const Block& block, std::ptrdiff_t slice) {
    return simd::load_aligned(block.lane + slice * width);
}
[[gnu::always_inline]] inline void set(Block& block, std::ptrdiff_t slice, Vector value) {
    simd::store_aligned(value, block.lane + slice * width);
}

/// A slice of the four parts of an unknown.
struct Value {
    Vector part[parts];
};
[[gnu::always_inline]] inline Value get_parts(const Block* blocks, std::ptrdiff_t slice) {
    return {{get(blocks[0], slice), get(blocks[1], slice), get(blocks[2], slice),
             get(blocks[3], slice)}};
}
[[gnu::always_inline]] inline void set_parts(Block* blocks, std::ptrdiff_t slice, const Value& v) {
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        set(blocks[p], slice, v.part[p]);
}
/// v += factor * x and v -= factor * x.
[[gnu::always_inline]] inline void add(Vector factor, const Value& x, Value& v) {
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        v.part[p] += factor * x.part[p];
}
[[gnu::always_inline]] inline void subtract(Vector factor, const Value& x, Value& v) {
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        v.part[p] -= factor * x.part[p];
}

// The end of an absorber. Motion without rotation below it, e^{-az} with
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
