// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/window.hpp"

#include "engines/spectral/kernels/slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

// With the folds E = F(kx) + F(-kx) and O = F(kx) - F(-kx), turned to the middle of the window,
//     f(middle +- d) = sum over kx >= 0 of E cos(kx d) +- i O sin(kx d),
// so that cosines and sines are multiplied by real numbers only.

std::ptrdiff_t blocks_of(std::ptrdiff_t count) {
    return (count + lane_count - 1) / lane_count;
}

/// Sums over kx for `together` blocks of distances and `planes` planes. One read of an angle serves
/// several products, and there are enough independent sums to hide the latency of additions.
template <std::ptrdiff_t planes, std::ptrdiff_t together>
void put_distances(const WindowArrays& a, std::ptrdiff_t block, const double* line,
                   std::ptrdiff_t line_stride, double* window, std::ptrdiff_t window_stride) {
    const std::ptrdiff_t half = a.nx / 2, pitch = fold_pitch(a.nx), middle = a.count / 2,
                         last = block + together;
    Block sums[planes][together][folds];
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        Vector sum[planes][together][folds] = {};
        for (std::ptrdiff_t k = 0; k < half; ++k)
            for (std::ptrdiff_t t = 0; t < together; ++t) {
                const Turn& turn = a.by_distance[(block + t) * half + k];
                const Vector c = get(turn.cosine, s), i = get(turn.sine, s);
                for (std::ptrdiff_t p = 0; p < planes; ++p) {
                    const double* fold = line + p * line_stride + k;
                    sum[p][t][even_re] += c * fold[even_re * pitch];
                    sum[p][t][even_im] += c * fold[even_im * pitch];
                    sum[p][t][odd_re] += i * fold[odd_re * pitch];
                    sum[p][t][odd_im] += i * fold[odd_im * pitch];
                }
            }
        for (std::ptrdiff_t p = 0; p < planes; ++p)
            for (std::ptrdiff_t t = 0; t < together; ++t)
                for (std::ptrdiff_t f = 0; f < folds; ++f)
                    set(sums[p][t][f], s, sum[p][t][f]);
    }
    for (std::ptrdiff_t p = 0; p < planes; ++p) {
        double* to = window + p * window_stride;
        for (std::ptrdiff_t i = block * lane_count; i < last * lane_count && i < a.reach; ++i) {
            const Block* sum = sums[p][i / lane_count - block];
            const std::ptrdiff_t lane = i % lane_count, d = i + 1;
            double *left = to + 2 * (middle - d), *right = to + 2 * (middle + d);
            left[0] = sum[even_re][lane] + sum[odd_im][lane];
            left[1] = sum[even_im][lane] - sum[odd_re][lane];
            if (middle + d >= a.count) break; // an even number of points ends on the left
            right[0] = sum[even_re][lane] - sum[odd_im][lane];
            right[1] = sum[even_im][lane] + sum[odd_re][lane];
        }
    }
}

/// The sums at the middle, where all angles are 0.
void put_middle(const WindowArrays& a, const double* line, double* window) {
    const std::ptrdiff_t half = a.nx / 2;
    for (std::ptrdiff_t part = 0; part < 2; ++part) {
        const double* fold = line + (even_re + part) * fold_pitch(a.nx);
        Block sums{};
        std::ptrdiff_t k = 0;
        for (; k + lane_count <= half; k += lane_count)
            for (std::ptrdiff_t s = 0; s < slices; ++s)
                set(sums, s, get(sums, s) + simd::load(fold + k + s * width));
        double all = sum_of(sums) - 0.5 * fold[0]; // kx = 0 is its own mirror image
        for (; k < half; ++k)
            all += fold[k];
        window[2 * (a.count / 2) + part] = all;
    }
}

template <std::ptrdiff_t planes>
void put_all_distances(const WindowArrays& a, const double* line, std::ptrdiff_t line_stride,
                       double* window, std::ptrdiff_t window_stride) {
    for (std::ptrdiff_t p = 0; p < planes; ++p)
        put_middle(a, line + p * line_stride, window + p * window_stride);
    const std::ptrdiff_t blocks = blocks_of(a.reach);
    std::ptrdiff_t block = 0;
    for (; block + 3 <= blocks; block += 3)
        put_distances<planes, 3>(a, block, line, line_stride, window, window_stride);
    if (block + 2 <= blocks) {
        put_distances<planes, 2>(a, block, line, line_stride, window, window_stride);
        block += 2;
    }
    if (block < blocks)
        put_distances<planes, 1>(a, block, line, line_stride, window, window_stride);
}

void to_window(const WindowArrays& a, std::ptrdiff_t planes, const double* line,
               std::ptrdiff_t line_stride, double* window, std::ptrdiff_t window_stride) {
    std::ptrdiff_t p = 0;
    for (; p + 2 <= planes; p += 2)
        put_all_distances<2>(a, line + p * line_stride, line_stride, window + p * window_stride,
                             window_stride);
    if (p < planes)
        put_all_distances<1>(a, line + p * line_stride, line_stride, window + p * window_stride,
                             window_stride);
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
    const std::ptrdiff_t distances = a.reach + 1, pitch = fold_pitch(a.nx);
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
            double* to = line + p * stride + block * lane_count + s * width;
            // F(+-kx) = E -+ i O
            for (std::ptrdiff_t t = 0; t < together; ++t, to += lane_count) {
                simd::store(sum[t][even_re], to + even_re * pitch);
                simd::store(sum[t][even_im], to + even_im * pitch);
                simd::store(sum[t][odd_im], to + odd_re * pitch);
                simd::store(-sum[t][odd_re], to + odd_im * pitch);
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
