// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/lines.hpp"

#include "engines/spectral/kernels/line_slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

[[gnu::always_inline]] inline Value mirrored(Symmetry symmetry, const Value& v) {
    if (!symmetry.odd) return v;
    return {{v.part[plus_re], v.part[plus_im], -v.part[minus_re], -v.part[minus_im]}};
}

void put(const WaveBlock& waves, Symmetry symmetry, const Block* parts_of, double* line) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Value v = mirrored(symmetry, get_parts(parts_of, s));
        put_slice(waves, s, symmetry.imaginary ? times_i(v) : v, line);
    }
}

void gather(const WaveBlock& waves, Symmetry symmetry, const double* line, Block* parts_of) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Value v = load_slice(waves, s, line);
        set_parts(parts_of, s, mirrored(symmetry, symmetry.imaginary ? times_minus_i(v) : v));
    }
}

constexpr LineKernels table = {put, gather};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::LineKernels&
shearwake::simd::compiled<shearwake::spectral::LineKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
