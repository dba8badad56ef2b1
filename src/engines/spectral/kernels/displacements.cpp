// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/displacements.hpp"

#include "engines/spectral/kernels/line_slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

void displacement(const DisplacementArrays& a, const WaveBlock& waves, const Block* pencil,
                  double* line, std::ptrdiff_t stride) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        for (std::ptrdiff_t d = 0; d < a.depths; ++d) {
            const AtDepth at =
                interpolated(a.nodes, a.levels, a.depth[d].first, a.depth[d].weights, s, pencil);
            const Lateral l = lateral_of(to, at);
            double* first = line + 3 * d * stride;
            put_slice(waves, s, times_i(l.x), first);
            put_slice(waves, s, times_i(l.y), first + stride);
            put_slice(waves, s, at.w, first + 2 * stride);
        }
    }
}

void add_force(const DisplacementArrays& a, const WaveBlock& waves, const double* line,
               std::ptrdiff_t stride, double scale, Block* pencil) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        for (std::ptrdiff_t d = 0; d < a.depths; ++d) {
            const double* first = line + 3 * d * stride;
            const Lateral l = {times_minus_i(load_slice(waves, s, first)),
                               times_minus_i(load_slice(waves, s, first + stride))};
            add_to_nodes(a.nodes, a.levels, a.depth[d].first, a.depth[d].weights, scale,
                         radial_of(to, l, load_slice(waves, s, first + 2 * stride)), s, pencil);
        }
    }
}

constexpr DisplacementKernels table = {displacement, add_force};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::DisplacementKernels&
shearwake::simd::compiled<shearwake::spectral::DisplacementKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
