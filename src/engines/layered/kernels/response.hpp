// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace shearwake::layered {

/// Kernels of the layered engine. Complex numbers are pairs of doubles, re and im.
struct ResponseKernels {
    /// product[i] = a[i] b[i] for i < count, complex.
    void (*multiply)(const double* a, const double* b, std::ptrdiff_t count, double* product);

    /// Adds coefficient l of node n times its value to samples[first[n] + l], cyclically: `taps`
    /// coefficients per node, each twice; values and samples are complex.
    void (*distribute)(const double* values, const double* coefficients,
                       const std::ptrdiff_t* first, std::ptrdiff_t nodes, std::ptrdiff_t taps,
                       double* samples, std::ptrdiff_t count);

    /// line[n] += sum_b jumps[b] sum_v weights[b][v][n] h[v] for n < count, b < orders and v <
    /// values; line and jumps are complex.
    void (*add_tail)(const double* h, std::ptrdiff_t values, const double* weights,
                     std::ptrdiff_t count, const double* jumps, std::ptrdiff_t orders,
                     double* line);

    /// Spectrum of the response (h times load times roll-off) at every samples/coarse-th time
    /// sample: higher frequencies fold onto the `coarse` frequencies of `line`. h and roll are
    /// given for m = 0 ... samples/2, and h(-m) is the conjugate of h(m); the load is given for all
    /// m. The load at the highest frequency, samples/2, is left out.
    void (*respond)(const double* h, const double* roll, const double* load, std::ptrdiff_t samples,
                    std::ptrdiff_t coarse, double* line);

    /// Transposes `lines` lines of `count` complex numbers, which begin `pitch` numbers apart, to
    /// `count` groups of `lines` numbers, which begin `stride` numbers apart.
    void (*turn)(const double* lines_begin, std::ptrdiff_t lines, std::ptrdiff_t pitch,
                 std::ptrdiff_t count, std::ptrdiff_t stride, double* out);

    /// row[i] = growth * factors[i] * values[i] for i = 0 ... n - 1, complex.
    void (*scale_row)(const double* values, const double* factors, double growth, std::ptrdiff_t n,
                      double* row);
    /// As scale_row, but `values` are given for i = 0 ... n/2; the value at n - i is the conjugate.
    void (*scale_mirrored_row)(const double* values, const double* factors, double growth,
                               std::ptrdiff_t n, double* row);

    /// Computes sum_j coefficients[j] T_j(x_i) with `order` (even) complex coefficients for `count`
    /// arguments; results are `stride` complex numbers apart.
    void (*chebyshev)(const double* coefficients, std::ptrdiff_t order, const double* x,
                      std::ptrdiff_t count, double* out, std::ptrdiff_t stride);
};

} // namespace shearwake::layered
