// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/markers.hpp"

#include "engines/spectral/kernels/line_slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

/// Sums and differences of the contributions of +kx and -kx.
struct Folded {
    Vector re_cos, re_sin, im_cos, im_sin;
};

void evaluate(const MarkerArrays& a, const WaveBlock& waves, const Block& mirrored,
              const Block* pencil, const Block* phase, Block* values) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        const Vector counts = get(mirrored, s);
        for (std::ptrdiff_t d = 0; d < a.depths; ++d) {
            const MarkerDepth& depth = a.depth[d];
            const AtDepth at =
                interpolated(a.nodes, a.levels, depth.first, depth.weights, s, pencil);
            const auto [x, y] = lateral_of(to, at);
            const Value moved[marker_components] = {a.along_x ? x : y, times_i(a.along_x ? y : x),
                                                    at.w};
            Folded folded[marker_components];
            for (int c = 0; c < marker_components; ++c) {
                const Value& m = moved[c];
                const Vector re = counts * a.mirrored_re[c] * m.part[minus_re];
                const Vector im = counts * a.mirrored_im[c] * m.part[minus_im];
                folded[c] = {m.part[plus_re] + re, im - m.part[plus_im], m.part[plus_im] + im,
                             m.part[plus_re] - re};
            }
            for (std::ptrdiff_t i = depth.begin; i < depth.end; ++i) {
                const Vector cosine = get(phase[2 * i], s), sine = get(phase[2 * i + 1], s);
                Block* to_add = values + i * marker_parts;
                for (int c = 0; c < marker_components; ++c) {
                    Block &re = to_add[2 * c], &im = to_add[2 * c + 1];
                    set(re, s, get(re, s) + cosine * folded[c].re_cos + sine * folded[c].re_sin);
                    set(im, s, get(im, s) + cosine * folded[c].im_cos + sine * folded[c].im_sin);
                }
            }
        }
    }
}

/// The sum over the markers of one depth as a force along the three components at +kx and -kx.
[[gnu::always_inline]] inline Value force_on(const MarkerArrays& a, const MarkerDepth& depth, int c,
                                             std::ptrdiff_t s, const Block* values,
                                             const Block* phase) {
    Vector cos_re{}, cos_im{}, sin_re{}, sin_im{};
    for (std::ptrdiff_t i = depth.begin; i < depth.end; ++i) {
        const Vector cosine = get(phase[2 * i], s), sine = get(phase[2 * i + 1], s);
        const Vector re = get(values[i * marker_parts + 2 * c], s);
        const Vector im = get(values[i * marker_parts + 2 * c + 1], s);
        cos_re += cosine * re;
        cos_im += cosine * im;
        sin_re += sine * re;
        sin_im += sine * im;
    }
    return {{cos_re + sin_im, cos_im - sin_re, a.mirrored_re[c] * (cos_re - sin_im),
             a.mirrored_im[c] * (cos_im + sin_re)}};
}

void add_force(const MarkerArrays& a, const WaveBlock& waves, const Block* values,
               const Block* phase, double scale, Block* pencil) {
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Direction to = direction(waves, s);
        for (std::ptrdiff_t d = 0; d < a.depths; ++d) {
            const MarkerDepth& depth = a.depth[d];
            const Value f_along = force_on(a, depth, along, s, values, phase);
            const Value f_across = times_minus_i(force_on(a, depth, across, s, values, phase));
            const Value f_down = force_on(a, depth, down, s, values, phase);
            const Lateral l = {a.along_x ? f_along : f_across, a.along_x ? f_across : f_along};
            add_to_nodes(a.nodes, a.levels, depth.first, depth.weights, scale,
                         radial_of(to, l, f_down), s, pencil);
        }
    }
}

constexpr MarkerKernels table = {evaluate, add_force};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::MarkerKernels&
shearwake::simd::compiled<shearwake::spectral::MarkerKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
