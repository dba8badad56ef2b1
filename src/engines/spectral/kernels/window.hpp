// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/lines.hpp"

namespace shearwake::spectral {

/// A window of `count` consecutive points of a line over x of `nx` points, and the angles kx d of
/// all kx >= 0 and all distances d from the middle point of the window.
struct WindowArrays {
    std::ptrdiff_t nx, count;
    std::ptrdiff_t reach; // largest distance from the middle
    /// [block of distances from 1][kx]; half for kx = 0, which is its own mirror image.
    const Turn* by_distance;
    const Turn* by_kx; // [block of kx][distance]
};

/// Transforms of folded lines over x (WaveBlock::middle) of which only a window is needed, or is
/// not zero. For short windows these sums are faster than FFTs. `line` and `window` are those of
/// the first plane; `line_stride` and `window_stride` are the numbers of doubles between planes.
/// The Nyquist mode is neither read nor written.
struct WindowKernels {
    /// Sum over kx of F(kx) e^{i kx x}.
    void (*to_window)(const WindowArrays& a, std::ptrdiff_t planes, const double* line,
                      std::ptrdiff_t line_stride, double* window, std::ptrdiff_t window_stride);
    /// Sum over x of f(x) e^{-i kx x}. `scratch` holds 4 (reach + 1) doubles per plane.
    void (*to_line)(const WindowArrays& a, std::ptrdiff_t planes, const double* window,
                    std::ptrdiff_t window_stride, double* line, std::ptrdiff_t line_stride,
                    double* scratch);
};

} // namespace shearwake::spectral
