// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/lines.hpp"

namespace shearwake::spectral {

/// A window of `count` consecutive points of a line over x of `nx` points, and the angles kx d of
/// distances d from the middle point of the window. Since cos((nx/2 - k) d) = +-cos(k d) and
/// sin((nx/2 - k) d) = -+sin(k d) for even and odd d, half of the kx >= 0 are enough.
struct WindowArrays {
    std::ptrdiff_t nx, count;
    std::ptrdiff_t reach; // largest distance from the middle
    /// [block of distances from 1][kx from 0 to paired(nx)]; half for kx that are their own mirror
    /// images: 0, and nx/4 if it is an integer.
    const Turn* by_distance;
    const Turn* by_kx; // [block of kx from 0 to paired(nx) - 1][distance from 0]
};

/// The number of kx >= 0 below nx/4, whose counterparts nx/2 - kx lie above.
constexpr std::ptrdiff_t paired(std::ptrdiff_t nx) {
    return (nx / 2 + 1) / 2;
}

/// Transforms of folded lines over x (WaveBlock::middle) of which only a window is needed, or is
/// not zero. For short windows these sums are faster than FFTs. `line` and `window` are those of
/// the first plane; `line_stride` and `window_stride` are the numbers of doubles between planes.
/// The Nyquist mode is neither read nor written.
struct WindowKernels {
    /// Sum over kx of F(kx) e^{i kx x}. `scratch` holds 8 (paired(nx) + 1) doubles.
    void (*to_window)(const WindowArrays& a, std::ptrdiff_t planes, const double* line,
                      std::ptrdiff_t line_stride, double* window, std::ptrdiff_t window_stride,
                      double* scratch);
    /// Sum over x of f(x) e^{-i kx x}. `scratch` holds 4 (reach + 1) doubles per plane.
    void (*to_line)(const WindowArrays& a, std::ptrdiff_t planes, const double* window,
                    std::ptrdiff_t window_stride, double* line, std::ptrdiff_t line_stride,
                    double* scratch);
};

} // namespace shearwake::spectral
