#pragma once

#include "base/lanes.hpp"

#include <complex>
#include <cstddef>

namespace shearwake {

// Lanes are eight neighbouring wavenumbers.

/// The real and imaginary parts at +kx and at -kx: they share one real matrix.
constexpr std::ptrdiff_t parts = 4;
enum Part { plus_re, plus_im, minus_re, minus_im };

/// Eight complex numbers in memory, first lane first.
inline void store_ascending(std::complex<double>* to, Lanes re, Lanes im) {
    Lanes* out = lanes(reinterpret_cast<double*>(to));
    out[0] = __builtin_shufflevector(re, im, 0, 8, 1, 9, 2, 10, 3, 11);
    out[1] = __builtin_shufflevector(re, im, 4, 12, 5, 13, 6, 14, 7, 15);
}
/// Eight complex numbers in memory, last lane first.
inline void store_descending(std::complex<double>* to, Lanes re, Lanes im) {
    Lanes* out = lanes(reinterpret_cast<double*>(to));
    out[0] = __builtin_shufflevector(re, im, 7, 15, 6, 14, 5, 13, 4, 12);
    out[1] = __builtin_shufflevector(re, im, 3, 11, 2, 10, 1, 9, 0, 8);
}
inline void load_ascending(const std::complex<double>* from, Lanes& re, Lanes& im) {
    const Lanes* in = lanes(reinterpret_cast<const double*>(from));
    re = __builtin_shufflevector(in[0], in[1], 0, 2, 4, 6, 8, 10, 12, 14);
    im = __builtin_shufflevector(in[0], in[1], 1, 3, 5, 7, 9, 11, 13, 15);
}
inline void load_descending(const std::complex<double>* from, Lanes& re, Lanes& im) {
    const Lanes* in = lanes(reinterpret_cast<const double*>(from));
    re = __builtin_shufflevector(in[0], in[1], 14, 12, 10, 8, 6, 4, 2, 0);
    im = __builtin_shufflevector(in[0], in[1], 15, 13, 11, 9, 7, 5, 3, 1);
}

} // namespace shearwake
