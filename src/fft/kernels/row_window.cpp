// SPDX-License-Identifier: BSD-3-Clause
#include "fft/kernels/row_window.hpp"

#include "simd/kernels.hpp"
#include "simd/vector.hpp"

// With the sums e and differences o of the points at equal distances d from the middle,
//     F(ky) = e^{-i ky middle} (sum over d of e cos(ky d) - i o sin(ky d)).
// Real and imaginary parts are sums of their own, and one angle serves two points.

namespace shearwake::fft {
namespace {

using simd::load_aligned;
using simd::store_aligned;
using simd::Vector;
using simd::width;

constexpr std::ptrdiff_t pair = 2 * window_rows; // two numbers for each row

/// Writes e and o, [distance][e, o][row]. Distance 0 counts once.
void fold(const RowWindowArrays& a, const double* rows, double* folded) {
    const std::ptrdiff_t middle = a.count / 2;
    for (std::ptrdiff_t d = 0; d <= a.reach; ++d) {
        const double* left = rows + (middle - d) * window_rows;
        const double* right = rows + (middle + d) * window_rows;
        const bool is_there = d > 0 && middle + d < a.count;
        for (std::ptrdiff_t r = 0; r < window_rows; r += width) {
            const Vector l = load_aligned(left + r), zero{};
            const Vector beyond = is_there ? load_aligned(right + r) : zero;
            store_aligned(l + beyond, folded + d * pair + r);
            store_aligned(beyond - l, folded + d * pair + window_rows + r);
        }
    }
}

/// The sums for `together` modes, so that one read of e and o serves several products.
template <std::ptrdiff_t together>
void put_modes(const RowWindowArrays& a, std::ptrdiff_t ky, const double* folded, double* modes) {
    const std::ptrdiff_t distances = a.reach + 1;
    for (std::ptrdiff_t r = 0; r < window_rows; r += width) {
        Vector re[together] = {}, im[together] = {};
        for (std::ptrdiff_t d = 0; d < distances; ++d) {
            const Vector e = load_aligned(folded + d * pair + r),
                         o = load_aligned(folded + d * pair + window_rows + r);
            for (std::ptrdiff_t t = 0; t < together; ++t) {
                const double* angle = a.angles + 2 * ((ky + t) * distances + d);
                re[t] += angle[0] * e;
                im[t] -= angle[1] * o;
            }
        }
        for (std::ptrdiff_t t = 0; t < together; ++t) {
            const double c = a.middle[2 * (ky + t)], s = a.middle[2 * (ky + t) + 1];
            simd::store_ascending(c * re[t] + s * im[t], c * im[t] - s * re[t],
                                  modes + (ky + t) * pair + 2 * r);
        }
    }
}

void to_modes(const RowWindowArrays& a, const double* rows, double* modes, double* scratch) {
    fold(a, rows, scratch);
    std::ptrdiff_t ky = 0;
    for (; ky + 8 <= a.modes; ky += 8)
        put_modes<8>(a, ky, scratch, modes);
    for (; ky < a.modes; ++ky)
        put_modes<1>(a, ky, scratch, modes);
}

/// The sums for the points at `together` distances.
template <std::ptrdiff_t together>
void put_points(const RowWindowArrays& a, std::ptrdiff_t first, const double* turned,
                double* rows) {
    const std::ptrdiff_t distances = a.reach + 1, middle = a.count / 2;
    for (std::ptrdiff_t r = 0; r < window_rows; r += width) {
        Vector even[together] = {}, odd[together] = {};
        for (std::ptrdiff_t ky = 0; ky < a.modes; ++ky) {
            const Vector re = load_aligned(turned + ky * pair + r),
                         im = load_aligned(turned + ky * pair + window_rows + r);
            const double* angle = a.angles + 2 * (ky * distances + first);
            for (std::ptrdiff_t t = 0; t < together; ++t) {
                even[t] += angle[2 * t] * re;
                odd[t] += angle[2 * t + 1] * im;
            }
        }
        for (std::ptrdiff_t t = 0; t < together; ++t) {
            const std::ptrdiff_t d = first + t;
            store_aligned(even[t] + odd[t], rows + (middle - d) * window_rows + r);
            if (middle + d < a.count)
                store_aligned(even[t] - odd[t], rows + (middle + d) * window_rows + r);
        }
    }
}

void to_rows(const RowWindowArrays& a, const double* modes, double* rows, double* scratch) {
    for (std::ptrdiff_t ky = 0; ky < a.modes; ++ky) {
        const double c = a.weights[ky] * a.middle[2 * ky], s = a.weights[ky] * a.middle[2 * ky + 1];
        for (std::ptrdiff_t r = 0; r < window_rows; r += width) {
            Vector re, im;
            simd::load_ascending(modes + ky * pair + 2 * r, re, im);
            store_aligned(c * re - s * im, scratch + ky * pair + r);
            store_aligned(c * im + s * re, scratch + ky * pair + window_rows + r);
        }
    }
    std::ptrdiff_t d = 0;
    for (; d + 6 <= a.reach + 1; d += 6)
        put_points<6>(a, d, scratch, rows);
    for (; d + 2 <= a.reach + 1; d += 2)
        put_points<2>(a, d, scratch, rows);
    for (; d <= a.reach; ++d)
        put_points<1>(a, d, scratch, rows);
}

constexpr RowWindowKernels table = {to_modes, to_rows};

} // namespace
} // namespace shearwake::fft

template <>
const shearwake::fft::RowWindowKernels&
shearwake::simd::compiled<shearwake::fft::RowWindowKernels, shearwake::simd::this_set>() {
    return fft::table;
}
