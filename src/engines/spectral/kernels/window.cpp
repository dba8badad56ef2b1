// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/window.hpp"

#include "engines/spectral/kernels/slices.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cstddef>

namespace shearwake::spectral {
namespace {

// With the folds E = F(kx) + F(-kx) and O = F(kx) - F(-kx), turned to the middle of the window,
//     f(middle +- d) = sum over kx >= 0 of E cos(kx d) +- i O sin(kx d),
// so that cosines and sines are multiplied by real numbers only. Sums over kx and its counterpart
// nx/2 - kx, which have the same angles except for signs, halve the number of products.

/// Sums that are kept in registers at the same time. Each has a real and an imaginary part.
constexpr std::ptrdiff_t most_together = 6;

/// Calls act.operator()<n>(first) for groups of n <= most_together of `count` slices.
template <class Act>
void each_group(std::ptrdiff_t count, const Act& act) {
    const std::ptrdiff_t groups = (count + most_together - 1) / most_together;
    std::ptrdiff_t first = 0;
    for (std::ptrdiff_t g = 1; g <= groups; ++g) {
        const std::ptrdiff_t end = count * g / groups;
        switch (end - first) {
        case 1:
            act.template operator()<1>(first);
            break;
        case 2:
            act.template operator()<2>(first);
            break;
        case 3:
            act.template operator()<3>(first);
            break;
        case 4:
            act.template operator()<4>(first);
            break;
        case 5:
            act.template operator()<5>(first);
            break;
        default:
            act.template operator()<most_together>(first);
        }
        first = end;
    }
}

std::ptrdiff_t slices_of(std::ptrdiff_t count) {
    return (count + width - 1) / width;
}

/// The numbers of one kx for odd and for even distances.
constexpr std::ptrdiff_t parities = 2;

/// Writes the sums of a fold over each kx and its counterpart, [kx][odd, even]: here - there and
/// here + there if cosines belong to the fold, the other way round for sines.
enum class Waves { cosines, sines };
template <Waves waves>
void fold_half(std::ptrdiff_t half, const double* fold, double* to) {
    constexpr bool swaps = waves == Waves::sines;
    to[0] = to[1] = fold[0]; // the counterpart of kx = 0 is the Nyquist mode
    std::ptrdiff_t k = 1;
    for (; k + width <= half / 2 + 1; k += width) {
        const Vector here = simd::load(fold + k),
                     there = simd::reversed(simd::load(fold + half - k - width + 1));
        const Vector difference = here - there, sum = here + there;
        simd::store_ascending(swaps ? sum : difference, swaps ? difference : sum,
                              to + parities * k);
    }
    for (; k <= half / 2; ++k) {
        to[parities * k + (swaps ? 1 : 0)] = fold[k] - fold[half - k];
        to[parities * k + (swaps ? 0 : 1)] = fold[k] + fold[half - k];
    }
    for (; k < (half + 1) / 2 + 1; ++k)
        to[parities * k] = to[parities * k + 1] = 0.0;
}

/// All folds, [fold][kx][odd, even].
void fold_line(const WindowArrays& a, const double* line, double* folded) {
    const std::ptrdiff_t half = a.nx / 2, pitch = fold_pitch(a.nx),
                         size = parities * (paired(a.nx) + 1);
    fold_half<Waves::cosines>(half, line + even_re * pitch, folded + even_re * size);
    fold_half<Waves::cosines>(half, line + even_im * pitch, folded + even_im * size);
    fold_half<Waves::sines>(half, line + odd_re * pitch, folded + odd_re * size);
    fold_half<Waves::sines>(half, line + odd_im * pitch, folded + odd_im * size);
}

/// Where the cosines of some slices begin; the sines follow.
template <std::ptrdiff_t together>
struct Angles {
    const double* cosine[together];

    /// Slices from `slice` on of blocks of `pitch` turns.
    Angles(const Turn* turns, std::ptrdiff_t pitch, std::ptrdiff_t slice) {
        for (std::ptrdiff_t t = 0; t < together; ++t)
            cosine[t] =
                turns[(slice + t) / slices * pitch].cosine.lane + (slice + t) % slices * width;
    }
};
constexpr std::ptrdiff_t to_sine = offsetof(Turn, sine) / sizeof(double);

/// Products of a real and an imaginary part with some slices of cosines or sines, and their sums.
template <std::ptrdiff_t together>
struct Sums {
    Vector re[together], im[together];

    Sums() {
        for (std::ptrdiff_t t = 0; t < together; ++t)
            re[t] = im[t] = simd::in_register(Vector{}); // g++ would fill memory with zeros
    }
    /// Adds the products with the angles of turn n of each block, or with those `shift` behind.
    [[gnu::always_inline]] void add(const Angles<together>& angles, std::ptrdiff_t n,
                                    std::ptrdiff_t shift, Vector real, Vector imaginary) {
        const std::ptrdiff_t at = n * static_cast<std::ptrdiff_t>(sizeof(Turn) / sizeof(double));
        for (std::ptrdiff_t t = 0; t < together; ++t) {
            const Vector turn =
                simd::in_register(simd::load_aligned(angles.cosine[t] + at + shift));
            re[t] += turn * real;
            im[t] += turn * imaginary;
        }
    }
};

/// Whether the registers suffice for two loops at once, which hides more of the latency.
constexpr bool has_many_registers = width == 8;

/// Calls both functions for i = 0 ... count - 1.
template <class First, class Second>
[[gnu::always_inline]] inline void both(std::ptrdiff_t count, const First& first,
                                        const Second& second) {
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        first(i);
        if constexpr (has_many_registers) second(i);
    }
    for (std::ptrdiff_t i = 0; i < count && !has_many_registers; ++i)
        second(i);
}

/// The points at distances from d on, on both sides of the middle.
void put_points(const WindowArrays& a, std::ptrdiff_t d, Vector left_re, Vector left_im,
                Vector right_re, Vector right_im, double* window) {
    double *left = window + 2 * (a.count / 2 - d - width + 1),
           *right = window + 2 * (a.count / 2 + d);
    if (a.count / 2 + d + width <= a.count) {
        simd::store_descending(left_re, left_im, left);
        simd::store_ascending(right_re, right_im, right);
        return;
    }
    double numbers[2 * width];
    simd::store_descending(left_re, left_im, numbers);
    const std::ptrdiff_t outside = std::max<std::ptrdiff_t>(0, d + width - 1 - a.reach);
    std::copy(numbers + 2 * outside, numbers + 2 * width, left + 2 * outside);
    simd::store_ascending(right_re, right_im, numbers);
    std::copy_n(numbers, 2 * (a.count - a.count / 2 - d), right);
}

template <std::ptrdiff_t together>
void put_distances(const WindowArrays& a, std::ptrdiff_t slice, const double* folded,
                   double* window) {
    const std::ptrdiff_t modes = paired(a.nx) + 1, size = parities * modes;
    const Angles<together> angles(a.by_distance, modes, slice);
    Sums<together> even, odd;
    const auto add = [&](Sums<together>& sums, std::ptrdiff_t shift, const double* fold,
                         std::ptrdiff_t k) {
        sums.add(angles, k, shift, simd::load_in_turns(fold + parities * k),
                 simd::load_in_turns(fold + size + parities * k));
    };
    both(
        modes, [&](std::ptrdiff_t k) { add(even, 0, folded + even_re * size, k); },
        [&](std::ptrdiff_t k) { add(odd, to_sine, folded + odd_re * size, k); });
    for (std::ptrdiff_t t = 0; t < together; ++t)
        put_points(a, (slice + t) * width + 1, even.re[t] + odd.im[t], even.im[t] - odd.re[t],
                   even.re[t] - odd.im[t], even.im[t] + odd.re[t], window);
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

void to_window(const WindowArrays& a, std::ptrdiff_t planes, const double* line,
               std::ptrdiff_t line_stride, double* window, std::ptrdiff_t window_stride,
               double* scratch) {
    for (std::ptrdiff_t p = 0; p < planes; ++p, line += line_stride, window += window_stride) {
        put_middle(a, line, window);
        fold_line(a, line, scratch);
        each_group(slices_of(a.reach), [&]<std::ptrdiff_t together>(std::ptrdiff_t slice) {
            put_distances<together>(a, slice, scratch, window);
        });
    }
}

/// Writes the folds of a window, [distance][fold]; distance 0 counts once.
void fold_window(const WindowArrays& a, const double* window, double* folded) {
    const double* middle = window + 2 * (a.count / 2);
    const std::ptrdiff_t last = a.count - 1 - a.count / 2; // distance on the right
    const simd::Pair zero{};
    simd::store_pair(simd::load_pair(middle), folded + even_re);
    simd::store_pair(zero, folded + odd_re);
    for (std::ptrdiff_t d = 1; d <= a.reach; ++d) {
        const simd::Pair left = simd::load_pair(middle - 2 * d),
                         right = d <= last ? simd::load_pair(middle + 2 * d) : zero;
        simd::store_pair(left + right, folded + folds * d + even_re);
        simd::store_pair(right - left, folded + folds * d + odd_re);
    }
}

/// Writes the sums of some kx and of their counterparts to a fold. Those below `blocks` blocks are
/// written as kx, the others as counterparts, at all vector widths.
void put_pairs(const WindowArrays& a, std::ptrdiff_t k, Vector here, Vector there, double* fold) {
    const std::ptrdiff_t half = a.nx / 2,
                         end = (paired(a.nx) + lane_count - 1) / lane_count * lane_count;
    simd::store(here, fold + k);
    if (k > 0 && half - k - width + 1 >= end)
        return simd::store(simd::reversed(there), fold + half - k - width + 1);
    for (std::ptrdiff_t lane = k > 0 ? 0 : 1; lane < width && half - k - lane >= end; ++lane)
        fold[half - k - lane] = there[lane];
}

/// Sums of the folds `first` and `first` + 1 over even and over odd distances.
template <std::ptrdiff_t together>
[[gnu::always_inline]] inline void
sum_over_distances(std::ptrdiff_t reach, const Angles<together>& angles, std::ptrdiff_t shift,
                   const double* first, Sums<together>& even, Sums<together>& odd) {
    const auto add = [&](Sums<together>& sums, std::ptrdiff_t d) {
        sums.add(angles, d, shift, simd::all_lanes(first[folds * d]),
                 simd::all_lanes(first[folds * d + 1]));
    };
    both((reach + 1) / 2, [&](std::ptrdiff_t i) { add(even, 2 * i); },
         [&](std::ptrdiff_t i) { add(odd, 2 * i + 1); });
    if (reach % 2 == 0) add(even, reach);
}

/// The line for some slices of kx. The slots differ from the folds of the window, since
///     F(+-kx) = E -+ i O.
template <std::ptrdiff_t together>
void put_kx(const WindowArrays& a, std::ptrdiff_t slice, const Angles<together>& angles,
            const double* folded, double* line) {
    const std::ptrdiff_t pitch = fold_pitch(a.nx);
    {
        Sums<together> even, odd;
        sum_over_distances(a.reach, angles, 0, folded + even_re, even, odd);
        for (std::ptrdiff_t t = 0; t < together; ++t) {
            const std::ptrdiff_t k = (slice + t) * width;
            put_pairs(a, k, even.re[t] + odd.re[t], even.re[t] - odd.re[t], line + even_re * pitch);
            put_pairs(a, k, even.im[t] + odd.im[t], even.im[t] - odd.im[t], line + even_im * pitch);
        }
    }
    Sums<together> even, odd;
    sum_over_distances(a.reach, angles, to_sine, folded + odd_re, even, odd);
    for (std::ptrdiff_t t = 0; t < together; ++t) {
        const std::ptrdiff_t k = (slice + t) * width;
        put_pairs(a, k, odd.im[t] + even.im[t], odd.im[t] - even.im[t], line + odd_re * pitch);
        put_pairs(a, k, -odd.re[t] - even.re[t], even.re[t] - odd.re[t], line + odd_im * pitch);
    }
}

/// The mode nx/4, if it is the first one after complete blocks of kx. Its sines and cosines are 0,
/// 1 and -1.
void put_quarter(const WindowArrays& a, const double* folded, double* line) {
    const std::ptrdiff_t quarter = paired(a.nx);
    if (a.nx % 4 != 0 || quarter % lane_count != 0) return;
    double sums[folds] = {};
    for (std::ptrdiff_t d = 0; d <= a.reach; ++d) {
        const double sign = d % 4 < 2 ? 1.0 : -1.0;
        for (std::ptrdiff_t part = 0; part < 2; ++part) {
            const std::ptrdiff_t f = (d % 2 == 0 ? even_re : odd_re) + part;
            sums[f] += sign * folded[folds * d + f];
        }
    }
    const std::ptrdiff_t pitch = fold_pitch(a.nx);
    line[even_re * pitch + quarter] = sums[even_re];
    line[even_im * pitch + quarter] = sums[even_im];
    line[odd_re * pitch + quarter] = sums[odd_im];
    line[odd_im * pitch + quarter] = -sums[odd_re];
}

void to_line(const WindowArrays& a, std::ptrdiff_t planes, const double* window,
             std::ptrdiff_t window_stride, double* line, std::ptrdiff_t line_stride,
             double* scratch) {
    const std::ptrdiff_t of_plane = folds * (a.reach + 1);
    constexpr std::ptrdiff_t line_reals = 8; // of a cache
    for (std::ptrdiff_t p = 0; p < planes; ++p) {
        // The processor does not foresee short rows that are far apart.
        const double* ahead = window + std::min(p + 2, planes - 1) * window_stride;
        for (std::ptrdiff_t i = 0; i < 2 * a.count; i += line_reals)
            __builtin_prefetch(ahead + i);
        fold_window(a, window + p * window_stride, scratch + p * of_plane);
        put_quarter(a, scratch + p * of_plane, line + p * line_stride);
    }
    const std::ptrdiff_t all = (paired(a.nx) + lane_count - 1) / lane_count * slices;
    each_group(all, [&]<std::ptrdiff_t together>(std::ptrdiff_t slice) {
        const Angles<together> angles(a.by_kx, a.reach + 1, slice);
        for (std::ptrdiff_t p = 0; p < planes; ++p)
            put_kx(a, slice, angles, scratch + p * of_plane, line + p * line_stride);
    });
}

constexpr WindowKernels table = {to_window, to_line};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::WindowKernels&
shearwake::simd::compiled<shearwake::spectral::WindowKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
