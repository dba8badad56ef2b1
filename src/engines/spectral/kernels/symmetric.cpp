// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/symmetric.hpp"

#include "engines/spectral/kernels/slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

[[gnu::always_inline]] inline Vector load_floats(const float* from) {
    using Floats = float __attribute__((vector_size(width * sizeof(float))));
    Floats v;
    __builtin_memcpy(&v, from, sizeof v);
    return __builtin_convertvector(v, Vector);
}

enum class Bits { all, rounded };

template <Bits bits>
[[gnu::always_inline]] inline Vector entry_of(const SymmetricArrays& matrix, std::ptrdiff_t at) {
    const Vector high = load_floats(matrix.high + at);
    return bits == Bits::rounded ? high : high + load_floats(matrix.low + at);
}

/// An entry acts in its row and, except on the diagonal, in its column.
template <Bits bits>
void multiply(std::ptrdiff_t unknowns, const SymmetricArrays& matrix, const Block* x, Block* y) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        std::ptrdiff_t at = s * width;
        for (std::ptrdiff_t i = 0; i < unknowns; ++i) {
            const Value mine = get_parts(x + i * parts, s);
            Value sum{};
            for (std::ptrdiff_t j = 0; j < i; ++j, at += lane_count) {
                const Vector a = entry_of<bits>(matrix, at);
                add(a, get_parts(x + j * parts, s), sum);
                Value other = get_parts(y + j * parts, s);
                add(a, mine, other);
                set_parts(y + j * parts, s, other);
            }
            add(entry_of<bits>(matrix, at), mine, sum);
            at += lane_count;
            set_parts(y + i * parts, s, sum);
        }
    }
}

constexpr SymmetricKernels table = {multiply<Bits::all>, multiply<Bits::rounded>};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::SymmetricKernels&
shearwake::simd::compiled<shearwake::spectral::SymmetricKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
