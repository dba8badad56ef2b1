// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/window.hpp"

#include "engines/spectral/kernels/line_slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

// With E = F(kx) + F(-kx) and O = F(kx) - F(-kx), both turned to the middle of the window,
//     f(middle +- d) = sum over kx >= 0 of E cos(kx d) +- i O sin(kx d),
// so that cosines and sines are multiplied by real numbers only.

/// Real and imaginary parts of sums and differences.
enum Fold { even_re, even_im, odd_re, odd_im, folds };

/// Multiplies the parts at +kx by e^{i kx middle} and those at -kx by its conjugate; `sign` is that
/// of the exponent.
[[gnu::always_inline]] inline Value turned(const Turn& turn, std::ptrdiff_t s, double sign,
                                           const Value& v) {
    const Vector c = get(turn.cosine, s), i = sign * get(turn.sine, s);
    return {{c * v.part[plus_re] - i * v.part[plus_im], c * v.part[plus_im] + i * v.part[plus_re],
             c * v.part[minus_re] + i * v.part[minus_im],
             c * v.part[minus_im] - i * v.part[minus_re]}};
}

[[gnu::always_inline]] inline WaveBlock waves_of(const WindowArrays& a, std::ptrdiff_t block) {
    return {.kx = {}, .k = {}, .ky = 0.0, .first = block * lane_count, .nx = a.nx};
}

std::ptrdiff_t blocks_of(std::ptrdiff_t count) {
    return (count + lane_count - 1) / lane_count;
}

/// Writes the folds of a line, [fold][kx].
void fold_line(const WindowArrays& a, const double* line, double* folded) {
    const std::ptrdiff_t half = a.nx / 2;
    for (std::ptrdiff_t b = 0; b < blocks_of(half); ++b)
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            const Value v = turned(a.of_middle[b], s, 1.0, take_slice(waves_of(a, b), s, line));
            const Value fold = {
                {v.part[plus_re] + v.part[minus_re], v.part[plus_im] + v.part[minus_im],
                 v.part[plus_re] - v.part[minus_re], v.part[plus_im] - v.part[minus_im]}};
            const std::ptrdiff_t first = b * lane_count + s * width;
            for (std::ptrdiff_t f = 0; f < folds; ++f) {
                double* to = folded + f * half;
                if (first + width <= half)
                    simd::store(fold.part[f], to + first);
                else
                    for (std::ptrdiff_t lane = 0; first + lane < half; ++lane)
                        to[first + lane] = fold.part[f][lane];
            }
        }
}

/// Sums over kx for `together` blocks of distances and `planes` planes. One read of an angle serves
/// several products, and there are enough independent sums to hide the latency of additions.
template <std::ptrdiff_t planes, std::ptrdiff_t together>
void put_distances(const WindowArrays& a, std::ptrdiff_t block, const double* folded,
                   double* window, std::ptrdiff_t stride) {
    const std::ptrdiff_t half = a.nx / 2, middle = a.count / 2, last = block + together;
    Block sums[planes][together][folds];
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        Vector sum[planes][together][folds] = {};
        for (std::ptrdiff_t k = 0; k < half; ++k)
            for (std::ptrdiff_t t = 0; t < together; ++t) {
                const Turn& turn = a.by_distance[(block + t) * half + k];
                const Vector c = get(turn.cosine, s), i = get(turn.sine, s);
                for (std::ptrdiff_t p = 0; p < planes; ++p) {
                    const double* fold = folded + p * 2 * a.nx + k;
                    sum[p][t][even_re] += c * fold[even_re * half];
                    sum[p][t][even_im] += c * fold[even_im * half];
                    sum[p][t][odd_re] += i * fold[odd_re * half];
                    sum[p][t][odd_im] += i * fold[odd_im * half];
                }
            }
        for (std::ptrdiff_t p = 0; p < planes; ++p)
            for (std::ptrdiff_t t = 0; t < together; ++t)
                for (std::ptrdiff_t f = 0; f < folds; ++f)
                    set(sums[p][t][f], s, sum[p][t][f]);
    }
    for (std::ptrdiff_t p = 0; p < planes; ++p) {
        double* to = window + p * stride;
        for (std::ptrdiff_t d = block * lane_count; d < last * lane_count && d <= a.reach; ++d) {
            const Block* sum = sums[p][d / lane_count - block];
            const std::ptrdiff_t lane = d % lane_count;
            double *left = to + 2 * (middle - d), *right = to + 2 * (middle + d);
            left[0] = sum[even_re][lane] + sum[odd_im][lane];
            left[1] = sum[even_im][lane] - sum[odd_re][lane];
            if (middle + d >= a.count) break; // an even number of points ends on the left
            right[0] = sum[even_re][lane] - sum[odd_im][lane];
            right[1] = sum[even_im][lane] + sum[odd_re][lane];
        }
    }
}

template <std::ptrdiff_t planes>
void put_all_distances(const WindowArrays& a, const double* folded, double* window,
                       std::ptrdiff_t stride) {
    const std::ptrdiff_t blocks = blocks_of(a.reach + 1);
    std::ptrdiff_t block = 0;
    for (; block + 3 <= blocks; block += 3)
        put_distances<planes, 3>(a, block, folded, window, stride);
    if (block + 2 <= blocks) {
        put_distances<planes, 2>(a, block, folded, window, stride);
        block += 2;
    }
    if (block < blocks) put_distances<planes, 1>(a, block, folded, window, stride);
}

void to_window(const WindowArrays& a, std::ptrdiff_t planes, const double* line,
               std::ptrdiff_t line_stride, double* window, std::ptrdiff_t window_stride,
               double* scratch) {
    for (std::ptrdiff_t p = 0; p < planes; ++p)
        fold_line(a, line + p * line_stride, scratch + p * 2 * a.nx);
    std::ptrdiff_t p = 0;
    for (; p + 2 <= planes; p += 2)
        put_all_distances<2>(a, scratch + p * 2 * a.nx, window + p * window_stride, window_stride);
    if (p < planes)
        put_all_distances<1>(a, scratch + p * 2 * a.nx, window + p * window_stride, window_stride);
}

/// Writes the folds of a window, [distance][fold]; distance 0 counts once.
void fold_window(const WindowArrays& a, const double* window, double* folded) {
    const std::ptrdiff_t middle = a.count / 2;
    for (std::ptrdiff_t d = 0; d <= a.reach; ++d) {
        const double *left = window + 2 * (middle - d), *right = window + 2 * (middle + d);
        const bool is_there = d > 0 && middle + d < a.count;
        for (std::ptrdiff_t part = 0; part < 2; ++part) {
            const double beyond = is_there ? right[part] : 0.0;
            folded[folds * d + even_re + part] = left[part] + beyond;
            folded[folds * d + odd_re + part] = d > 0 ? beyond - left[part] : 0.0;
        }
    }
}

template <std::ptrdiff_t together>
void put_kx(const WindowArrays& a, std::ptrdiff_t block, std::ptrdiff_t planes,
            const double* folded, double* line, std::ptrdiff_t stride) {
    const std::ptrdiff_t distances = a.reach + 1;
    for (std::ptrdiff_t p = 0; p < planes; ++p)
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            Vector sum[together][folds] = {};
            const double* fold = folded + p * folds * distances;
            for (std::ptrdiff_t d = 0; d < distances; ++d, fold += folds)
                for (std::ptrdiff_t t = 0; t < together; ++t) {
                    const Turn& turn = a.by_kx[(block + t) * distances + d];
                    const Vector c = get(turn.cosine, s), i = get(turn.sine, s);
                    sum[t][even_re] += c * fold[even_re];
                    sum[t][even_im] += c * fold[even_im];
                    sum[t][odd_re] += i * fold[odd_re];
                    sum[t][odd_im] += i * fold[odd_im];
                }
            for (std::ptrdiff_t t = 0; t < together; ++t) {
                const Vector* of = sum[t]; // F(+-kx) = E -+ i O
                const Value v = {{of[even_re] + of[odd_im], of[even_im] - of[odd_re],
                                  of[even_re] - of[odd_im], of[even_im] + of[odd_re]}};
                put_slice(waves_of(a, block + t), s, turned(a.of_middle[block + t], s, -1.0, v),
                          line + p * stride);
            }
        }
}

void to_line(const WindowArrays& a, std::ptrdiff_t planes, const double* window,
             std::ptrdiff_t window_stride, double* line, std::ptrdiff_t line_stride,
             double* scratch) {
    for (std::ptrdiff_t p = 0; p < planes; ++p)
        fold_window(a, window + p * window_stride, scratch + p * folds * (a.reach + 1));
    const std::ptrdiff_t blocks = blocks_of(a.nx / 2);
    std::ptrdiff_t block = 0;
    for (; block + 2 <= blocks; block += 2)
        put_kx<2>(a, block, planes, scratch, line, line_stride);
    if (block < blocks) put_kx<1>(a, block, planes, scratch, line, line_stride);
}

constexpr WindowKernels table = {to_window, to_line};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::WindowKernels&
shearwake::simd::compiled<shearwake::spectral::WindowKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
