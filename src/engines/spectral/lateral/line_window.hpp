// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/window.hpp"
#include "fft/aligned.hpp"

namespace shearwake::spectral {

/// Transforms along x between complete spectra and a window of their points. Not collective.
class LineWindow {
public:
    /// Points [begin, begin + count) of lines of nx points.
    LineWindow(std::ptrdiff_t nx, std::ptrdiff_t begin, std::ptrdiff_t count);
    /// Whether the sums over a window of this length are faster than FFTs.
    static bool pays(std::ptrdiff_t nx, std::ptrdiff_t count);

    std::ptrdiff_t begin() const { return begin_; }
    std::ptrdiff_t count() const { return count_; }
    /// Number of doubles of a folded line, of which the last ones are unused, so that consecutive
    /// planes do not occupy the same sets of the cache; and its format for a block of wave vectors.
    std::ptrdiff_t line_reals() const { return folds * fold_pitch(nx_) + lane_count; }
    WaveBlock folded(WaveBlock waves) const {
        waves.middle = of_middle_.data() + waves.first / lane_count;
        return waves;
    }

    /// Transform `planes` folded lines; the strides are in doubles. Unnormalised.
    void to_window(std::ptrdiff_t planes, const double* line, std::ptrdiff_t line_stride,
                   double* window, std::ptrdiff_t window_stride);
    void to_line(std::ptrdiff_t planes, const double* window, std::ptrdiff_t window_stride,
                 double* line, std::ptrdiff_t line_stride);

private:
    WindowArrays arrays() const;
    double* scratch(std::ptrdiff_t size);

    const WindowKernels& kernels_;
    std::ptrdiff_t nx_, begin_, count_;
    fft::AlignedVector<Turn> by_distance_, by_kx_, of_middle_;
    fft::AlignedVector<double> scratch_;
};

} // namespace shearwake::spectral
