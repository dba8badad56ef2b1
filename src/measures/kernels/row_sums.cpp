// SPDX-License-Identifier: BSD-3-Clause
#include "measures/kernels/row_sums.hpp"

#include "simd/kernels.hpp"
#include "simd/vector.hpp"

namespace shearwake::measures {
namespace {

using namespace simd;

constexpr std::ptrdiff_t slices = lane_count / width; // of a block

struct Sums {
    Vector u[slices] = {}, abs_u[slices] = {}, u2[slices] = {}, u4[slices] = {}, peak[slices] = {};

    [[gnu::always_inline]] void add(const double* values) {
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            const Vector value = load(values + s * width);
            const Vector size = magnitude(value), square = value * value;
            u[s] += value;
            abs_u[s] += size;
            u2[s] += square;
            u4[s] += square * square;
            peak[s] = greater(size, peak[s]);
        }
    }
};

void row_sums(const double* values, std::ptrdiff_t count, RowSums8& sums) {
    Sums all;
    std::ptrdiff_t i = 0;
    for (; i + lane_count <= count; i += lane_count)
        all.add(values + i);
    if (i < count) { // zeros do not contribute
        double rest[lane_count] = {};
        for (std::ptrdiff_t lane = 0; i + lane < count; ++lane)
            rest[lane] = values[i + lane];
        all.add(rest);
    }
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const std::ptrdiff_t lane = s * width;
        store_aligned(all.u[s], sums.u.lane + lane);
        store_aligned(all.abs_u[s], sums.abs_u.lane + lane);
        store_aligned(all.u2[s], sums.u2.lane + lane);
        store_aligned(all.u4[s], sums.u4.lane + lane);
        store_aligned(all.peak[s], sums.peak.lane + lane);
    }
}

/// Adds four frames to two rows of sums, the parts of a complex one, which share the loads.
void add_four(const double* u0, std::ptrdiff_t count, const double* re, const double* im,
              double* sums) {
    const double *u1 = u0 + count, *u2 = u1 + count, *u3 = u2 + count;
    const Vector re0 = in_register(all_lanes(re[0])), re1 = in_register(all_lanes(re[1])),
                 re2 = in_register(all_lanes(re[2])), re3 = in_register(all_lanes(re[3])),
                 im0 = in_register(all_lanes(im[0])), im1 = in_register(all_lanes(im[1])),
                 im2 = in_register(all_lanes(im[2])), im3 = in_register(all_lanes(im[3]));
    for (std::ptrdiff_t j = 0; j < count; j += width) {
        Vector sum_re = load_aligned(sums + j), sum_im = load_aligned(sums + count + j);
        const Vector v0 = load_aligned(u0 + j), v1 = load_aligned(u1 + j),
                     v2 = load_aligned(u2 + j), v3 = load_aligned(u3 + j);
        sum_re += re0 * v0;
        sum_im += im0 * v0;
        sum_re += re1 * v1;
        sum_im += im1 * v1;
        sum_re += re2 * v2;
        sum_im += im2 * v2;
        sum_re += re3 * v3;
        sum_im += im3 * v3;
        store_aligned(sum_re, sums + j);
        store_aligned(sum_im, sums + count + j);
    }
}

void add_lines(const double* frames, std::ptrdiff_t used, std::ptrdiff_t count,
               const double* factors, std::ptrdiff_t lines, double* sums) {
    static_assert(line_frames % 4 == 0);
    constexpr auto all = static_cast<std::ptrdiff_t>(line_frames);
    for (std::ptrdiff_t k = 0; k < lines; k += 2, factors += 2 * all, sums += 2 * count)
        for (std::ptrdiff_t n = 0; n < used; n += 4) // the sums stay in the cache
            add_four(frames + n * count, count, factors + n, factors + all + n, sums);
}

constexpr RowSumKernels table = {row_sums, add_lines};

} // namespace
} // namespace shearwake::measures

template <>
const shearwake::measures::RowSumKernels&
shearwake::simd::compiled<shearwake::measures::RowSumKernels, shearwake::simd::this_set>() {
    return measures::table;
}
