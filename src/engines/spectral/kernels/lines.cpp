// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/lines.hpp"

#include "engines/spectral/kernels/line_slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

void put(const WaveBlock& waves, const Block* parts_of, double* line) {
    for (std::ptrdiff_t s = 0; s < slices; ++s)
        put_slice(waves, s, get_parts(parts_of, s), line);
}

void take(const WaveBlock& waves, const double* line, Block* parts_of) {
    for (std::ptrdiff_t s = 0; s < slices; ++s)
        set_parts(parts_of, s, take_slice(waves, s, line));
}

constexpr LineKernels table = {put, take};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::LineKernels&
shearwake::simd::compiled<shearwake::spectral::LineKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
