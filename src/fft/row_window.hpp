// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/aligned.hpp"
#include "fft/kernels/row_window.hpp"

#include <complex>

namespace shearwake::fft {

/// Transforms of window_rows rows at a time that are zero outside of a window of y, or are needed
/// only there, with precomputed cosines and sines. Not collective.
class RowWindow {
public:
    /// Whether the sums are faster than FFTs of rows of `ny` points.
    static bool pays(std::ptrdiff_t ny, std::ptrdiff_t count);
    /// A window of the points from `begin` on.
    RowWindow(std::ptrdiff_t ny, std::ptrdiff_t begin, std::ptrdiff_t count);

    /// The values of the rows at a point of the complete row.
    double* point(std::ptrdiff_t y) { return rows_.data() + (y - begin_) * window_rows; }
    void clear_rows();
    /// The coefficients of the rows at one of the ny/2 + 1 ky.
    std::complex<double>* mode(std::ptrdiff_t ky) { return modes_.data() + ky * window_rows; }
    /// Compute the modes from the points, and the points from the modes. Unnormalised.
    void to_modes();
    void to_rows();

private:
    RowWindowArrays arrays() const;

    const RowWindowKernels& kernels_;
    std::ptrdiff_t begin_, count_, mode_count_;
    AlignedVector<double> angles_, middle_, weights_, rows_, scratch_;
    AlignedVector<std::complex<double>> modes_;
};

} // namespace shearwake::fft
