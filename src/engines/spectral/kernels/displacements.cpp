// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/displacements.hpp"

#include "engines/spectral/kernels/line_slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

/// Calls use(weight, place of U and W, place of V) for the nodes of a depth.
template <class Use>
[[gnu::always_inline]] inline void each_node(const DisplacementArrays& a,
                                             const DisplacementDepth& depth, const Use& use) {
    for (std::ptrdiff_t j = 0; j < a.nodes && depth.first + j < a.levels; ++j)
        use(depth.weights[j], 2 * (depth.first + j) * parts,
            (2 * a.levels + depth.first + j) * parts);
}

void displacement(const DisplacementArrays& a, const WaveBlock& waves, const Block* pencil,
                  double* line, std::ptrdiff_t stride) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        for (std::ptrdiff_t d = 0; d < a.depths; ++d) {
            Value u{}, w{}, v{};
            each_node(a, a.depth[d], [&](double weight, std::ptrdiff_t uw, std::ptrdiff_t of_v) {
                const Vector all = simd::all_lanes(weight);
                add(all, get_parts(pencil + uw, s), u);
                add(all, get_parts(pencil + uw + parts, s), w);
                add(all, get_parts(pencil + of_v, s), v);
            });
            Value x, y; // u_x = i x, u_y = i y
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Vector c = to.c[p / 2];
                x.part[p] = c * u.part[p] - to.s * v.part[p];
                y.part[p] = to.s * u.part[p] + c * v.part[p];
            }
            double* first = line + 3 * d * stride;
            put_slice(waves, s, times_i(x), first);
            put_slice(waves, s, times_i(y), first + stride);
            put_slice(waves, s, w, first + 2 * stride);
        }
    }
}

void add_force(const DisplacementArrays& a, const WaveBlock& waves, const double* line,
               std::ptrdiff_t stride, double scale, Block* pencil) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        for (std::ptrdiff_t d = 0; d < a.depths; ++d) {
            const double* first = line + 3 * d * stride;
            const Value x = times_minus_i(load_slice(waves, s, first)),
                        y = times_minus_i(load_slice(waves, s, first + stride)),
                        z = load_slice(waves, s, first + 2 * stride);
            Value u, v;
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Vector c = to.c[p / 2];
                u.part[p] = c * x.part[p] + to.s * y.part[p];
                v.part[p] = c * y.part[p] - to.s * x.part[p];
            }
            each_node(a, a.depth[d], [&](double weight, std::ptrdiff_t uw, std::ptrdiff_t of_v) {
                const Vector all = simd::all_lanes(scale * weight);
                for (std::ptrdiff_t p = 0; p < parts; ++p) {
                    Block &to_u = pencil[uw + p], &to_w = pencil[uw + parts + p],
                          &to_v = pencil[of_v + p];
                    set(to_u, s, get(to_u, s) + all * u.part[p]);
                    set(to_w, s, get(to_w, s) + all * z.part[p]);
                    set(to_v, s, get(to_v, s) + all * v.part[p]);
                }
            });
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
