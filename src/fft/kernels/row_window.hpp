// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace shearwake::fft {

/// Number of rows that are transformed together.
constexpr std::ptrdiff_t window_rows = 8;

/// A window of `count` consecutive points of rows of real numbers, with the angles ky d of all
/// `modes` ky >= 0 and all distances d from 0 to `reach` from the middle point of the window.
struct RowWindowArrays {
    std::ptrdiff_t count, reach, modes;
    const double* angles;  // [ky][distance][cosine, sine]
    const double* middle;  // [ky][cosine, sine]: ky times the position of the middle
    const double* weights; // [ky]: how often a mode occurs in the sum over all ky
};

/// Transforms of rows that are zero outside of a window, or are needed only there. `rows` are
/// [point][row], `modes` [ky][row][re, im], both aligned to 64 bytes. For short windows these sums
/// are faster than FFTs.
struct RowWindowKernels {
    /// Sum over y of f(y) e^{-i ky y}. `scratch` holds 2 window_rows (reach + 1) doubles.
    void (*to_modes)(const RowWindowArrays& a, const double* rows, double* modes, double* scratch);
    /// Sum over all ky, of either sign, of F(ky) e^{i ky y}. `scratch` holds 2 window_rows doubles
    /// per mode.
    void (*to_rows)(const RowWindowArrays& a, const double* modes, double* rows, double* scratch);
};

} // namespace shearwake::fft
