// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/lines.hpp"
#include "engines/spectral/kernels/slices.hpp"

// For kernels only: transfers slices between registers and lines of spectra.

namespace shearwake::spectral {
namespace { // NOLINT(cert-dcl59-cpp): see simd/vector.hpp

/// i v and -i v.
[[gnu::always_inline]] inline Value times_i(const Value& v) {
    return {{-v.part[plus_im], v.part[plus_re], -v.part[minus_im], v.part[minus_re]}};
}
[[gnu::always_inline]] inline Value times_minus_i(const Value& v) {
    return {{v.part[plus_im], -v.part[plus_re], v.part[minus_im], -v.part[minus_re]}};
}

/// Whether the wave vectors +kx and -kx all exist and differ for the slice that begins at index i.
[[gnu::always_inline]] inline bool is_full(const WaveBlock& waves, std::ptrdiff_t i) {
    return i > 0 && 2 * (i + width - 1) < waves.nx;
}

/// Multiplies the parts at +kx by e^{i kx middle} and those at -kx by its conjugate; `sign` is that
/// of the exponent.
[[gnu::always_inline]] inline Value turned(const Turn& turn, std::ptrdiff_t s, double sign,
                                           const Value& v) {
    const Vector c = get(turn.cosine, s), i = sign * get(turn.sine, s);
    return {{c * v.part[plus_re] - i * v.part[plus_im], c * v.part[plus_im] + i * v.part[plus_re],
             c * v.part[minus_re] + i * v.part[minus_im],
             c * v.part[minus_im] - i * v.part[minus_re]}};
}

[[gnu::always_inline]] inline void put_folded(const WaveBlock& waves, std::ptrdiff_t slice, Value v,
                                              double* line) {
    const std::ptrdiff_t first = waves.first + slice * width, pitch = fold_pitch(waves.nx);
    if (first == 0) { // kx = 0 is its own mirror image
        v.part[minus_re][0] = v.part[plus_re][0];
        v.part[minus_im][0] = v.part[plus_im][0];
    }
    const Value f = turned(*waves.middle, slice, 1.0, v);
    simd::store(f.part[plus_re] + f.part[minus_re], line + even_re * pitch + first);
    simd::store(f.part[plus_im] + f.part[minus_im], line + even_im * pitch + first);
    simd::store(f.part[plus_re] - f.part[minus_re], line + odd_re * pitch + first);
    simd::store(f.part[plus_im] - f.part[minus_im], line + odd_im * pitch + first);
}

[[gnu::always_inline]] inline Value load_folded(const WaveBlock& waves, std::ptrdiff_t slice,
                                                const double* line) {
    const std::ptrdiff_t first = waves.first + slice * width, pitch = fold_pitch(waves.nx);
    const auto fold = [&](Fold f) { return simd::load(line + f * pitch + first); };
    return turned(*waves.middle, slice, -1.0,
                  {{fold(even_re) + fold(odd_re), fold(even_im) + fold(odd_im),
                    fold(even_re) - fold(odd_re), fold(even_im) - fold(odd_im)}});
}

/// Transfer the wave vectors of an incomplete slice lane by lane. These functions are called with
/// copies, because g++ keeps a Value whose lanes are accessed singly in memory, wherever it is
/// used.
[[gnu::noinline]] inline void put_existing(std::ptrdiff_t nx, std::ptrdiff_t first, Value v,
                                           double* line) {
    for (std::ptrdiff_t lane = 0; lane < width && 2 * (first + lane) < nx; ++lane) {
        const std::ptrdiff_t i = first + lane;
        line[2 * i] = v.part[plus_re][lane];
        line[2 * i + 1] = v.part[plus_im][lane];
        if (i == 0) continue;
        line[2 * (nx - i)] = v.part[minus_re][lane];
        line[2 * (nx - i) + 1] = v.part[minus_im][lane];
    }
}
[[gnu::noinline]] inline Value load_existing(std::ptrdiff_t nx, std::ptrdiff_t first,
                                             const double* line) {
    Value v{};
    for (std::ptrdiff_t lane = 0; lane < width && 2 * (first + lane) < nx; ++lane) {
        const std::ptrdiff_t i = first + lane, mirrored = (nx - i) % nx;
        v.part[plus_re][lane] = line[2 * i];
        v.part[plus_im][lane] = line[2 * i + 1];
        v.part[minus_re][lane] = line[2 * mirrored];
        v.part[minus_im][lane] = line[2 * mirrored + 1];
    }
    return v;
}

[[gnu::always_inline]] inline void put_slice(const WaveBlock& waves, std::ptrdiff_t slice,
                                             const Value& v, double* line) {
    if (waves.middle) return put_folded(waves, slice, v, line);
    const std::ptrdiff_t nx = waves.nx, first = waves.first + slice * width;
    if (!is_full(waves, first)) return put_existing(nx, first, v, line);
    simd::store_ascending(v.part[plus_re], v.part[plus_im], line + 2 * first);
    simd::store_descending(v.part[minus_re], v.part[minus_im], line + 2 * (nx - first - width + 1));
}

[[gnu::always_inline]] inline Value load_slice(const WaveBlock& waves, std::ptrdiff_t slice,
                                               const double* line) {
    if (waves.middle) return load_folded(waves, slice, line);
    const std::ptrdiff_t nx = waves.nx, first = waves.first + slice * width;
    if (!is_full(waves, first)) return load_existing(nx, first, line);
    Value v;
    simd::load_ascending(line + 2 * first, v.part[plus_re], v.part[plus_im]);
    simd::load_descending(line + 2 * (nx - first - width + 1), v.part[minus_re], v.part[minus_im]);
    return v;
}

/// c = kx/k and s = ky/k for +kx and -kx; the direction of x where k = 0.
struct Direction {
    Vector kx[2], c[2], s, ky;
};
[[gnu::always_inline]] inline Direction direction(const WaveBlock& waves, std::ptrdiff_t slice) {
    const Vector kx = get(waves.kx, slice), k = get(waves.k, slice);
    const Vector ky = simd::all_lanes(waves.ky), zero{}, one = simd::all_lanes(1.0);
    const Vector divisor = k > 0.0 ? k : one;
    const Vector c = kx / divisor;
    return {{kx, -kx}, {k > 0.0 ? c : one, k > 0.0 ? -c : one}, k > 0.0 ? ky / divisor : zero, ky};
}

/// U, W and V at a depth, or forces on them.
struct AtDepth {
    Value u{}, w{}, v{};
};

/// Calls use(weight, place of U and W in a pencil, place of V) for the nodes of an element from the
/// level `first` on. The base does not move.
template <class Use>
[[gnu::always_inline]] inline void each_node(std::ptrdiff_t nodes, std::ptrdiff_t levels,
                                             std::ptrdiff_t first, const double* weights,
                                             const Use& use) {
    for (std::ptrdiff_t j = 0; j < nodes && first + j < levels; ++j)
        use(weights[j], 2 * (first + j) * parts, (2 * levels + first + j) * parts);
}

[[gnu::always_inline]] inline AtDepth interpolated(std::ptrdiff_t nodes, std::ptrdiff_t levels,
                                                   std::ptrdiff_t first, const double* weights,
                                                   std::ptrdiff_t s, const Block* pencil) {
    AtDepth at;
    each_node(nodes, levels, first, weights,
              [&](double weight, std::ptrdiff_t uw, std::ptrdiff_t of_v) {
                  const Vector all = simd::all_lanes(weight);
                  add(all, get_parts(pencil + uw, s), at.u);
                  add(all, get_parts(pencil + uw + parts, s), at.w);
                  add(all, get_parts(pencil + of_v, s), at.v);
              });
    return at;
}

/// The adjoint of interpolated(), times `scale`: adds a force to a pencil.
[[gnu::always_inline]] inline void add_to_nodes(std::ptrdiff_t nodes, std::ptrdiff_t levels,
                                                std::ptrdiff_t first, const double* weights,
                                                double scale, const AtDepth& force,
                                                std::ptrdiff_t s, Block* pencil) {
    each_node(nodes, levels, first, weights,
              [&](double weight, std::ptrdiff_t uw, std::ptrdiff_t of_v) {
                  const Vector all = simd::all_lanes(scale * weight);
                  for (std::ptrdiff_t p = 0; p < parts; ++p) {
                      Block &to_u = pencil[uw + p], &to_w = pencil[uw + parts + p],
                            &to_v = pencil[of_v + p];
                      set(to_u, s, get(to_u, s) + all * force.u.part[p]);
                      set(to_w, s, get(to_w, s) + all * force.w.part[p]);
                      set(to_v, s, get(to_v, s) + all * force.v.part[p]);
                  }
              });
}

/// x and y of a lateral displacement u_x = i x, u_y = i y, or of a force.
struct Lateral {
    Value x, y;
};

[[gnu::always_inline]] inline Lateral lateral_of(const Direction& to, const AtDepth& at) {
    Lateral l;
    for (std::ptrdiff_t p = 0; p < parts; ++p) {
        const Vector c = to.c[p / 2];
        l.x.part[p] = c * at.u.part[p] - to.s * at.v.part[p];
        l.y.part[p] = to.s * at.u.part[p] + c * at.v.part[p];
    }
    return l;
}

[[gnu::always_inline]] inline AtDepth radial_of(const Direction& to, const Lateral& l,
                                                const Value& w) {
    AtDepth at;
    at.w = w;
    for (std::ptrdiff_t p = 0; p < parts; ++p) {
        const Vector c = to.c[p / 2];
        at.u.part[p] = c * l.x.part[p] + to.s * l.y.part[p];
        at.v.part[p] = c * l.y.part[p] - to.s * l.x.part[p];
    }
    return at;
}

} // namespace
} // namespace shearwake::spectral
