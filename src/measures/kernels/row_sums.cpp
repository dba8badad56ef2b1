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

void add_lines(const double* frames, std::ptrdiff_t count, const double* factors,
               std::ptrdiff_t lines, double* sums) {
    static_assert(line_frames == 4);
    const double *u0 = frames, *u1 = u0 + count, *u2 = u1 + count, *u3 = u2 + count;
    for (std::ptrdiff_t k = 0; k < lines; ++k, factors += line_frames, sums += count) {
        const Vector f0 = kept(all_lanes(factors[0])), f1 = kept(all_lanes(factors[1])),
                     f2 = kept(all_lanes(factors[2])), f3 = kept(all_lanes(factors[3]));
        std::ptrdiff_t j = 0;
        for (; j + width <= count; j += width) {
            Vector sum = load(sums + j);
            sum += f0 * load(u0 + j);
            sum += f1 * load(u1 + j);
            sum += f2 * load(u2 + j);
            sum += f3 * load(u3 + j);
            store(sum, sums + j);
        }
        for (; j < count; ++j) {
            double sum = sums[j];
            sum += factors[0] * u0[j];
            sum += factors[1] * u1[j];
            sum += factors[2] * u2[j];
            sum += factors[3] * u3[j];
            sums[j] = sum;
        }
    }
}

constexpr RowSumKernels table = {row_sums, add_lines};

} // namespace
} // namespace shearwake::measures

template <>
const shearwake::measures::RowSumKernels&
shearwake::simd::compiled<shearwake::measures::RowSumKernels, shearwake::simd::this_set>() {
    return measures::table;
}
