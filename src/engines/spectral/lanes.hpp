#pragma once

#include <cstddef>

namespace shearwake {

/// Eight neighbouring wavenumbers side by side: one vector instruction, or a few of a narrower
/// machine. A type of g++ and clang; loads need no alignment beyond a double's.
constexpr std::ptrdiff_t lane_count = 8;
using Lanes = double __attribute__((vector_size(8 * sizeof(double)), aligned(8), may_alias));

inline Lanes* lanes(double* values) {
    return reinterpret_cast<Lanes*>(values);
}
inline const Lanes* lanes(const double* values) {
    return reinterpret_cast<const Lanes*>(values);
}

/// The real and imaginary parts at +kx and at -kx: they share one real matrix.
constexpr std::ptrdiff_t parts = 4;
enum Part { plus_re, plus_im, minus_re, minus_im };

} // namespace shearwake
