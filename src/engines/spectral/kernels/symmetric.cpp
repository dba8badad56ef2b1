// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/symmetric.hpp"

#include "engines/spectral/kernels/slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

/// An entry acts in its row and, except on the diagonal, in its column.
void multiply(std::ptrdiff_t unknowns, const Block* triangle, const Block* x, Block* y) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Block* entry = triangle;
        for (std::ptrdiff_t i = 0; i < unknowns; ++i) {
            const Value mine = get_parts(x + i * parts, s);
            Value sum{};
            for (std::ptrdiff_t j = 0; j < i; ++j, ++entry) {
                const Vector a = get(*entry, s);
                add(a, get_parts(x + j * parts, s), sum);
                Value other = get_parts(y + j * parts, s);
                add(a, mine, other);
                set_parts(y + j * parts, s, other);
            }
            add(get(*entry++, s), mine, sum);
            set_parts(y + i * parts, s, sum);
        }
    }
}

constexpr SymmetricKernels table = {multiply};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::SymmetricKernels&
shearwake::simd::compiled<shearwake::spectral::SymmetricKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
