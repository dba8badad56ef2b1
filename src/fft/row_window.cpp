// SPDX-License-Identifier: BSD-3-Clause
#include "fft/row_window.hpp"

#include "base/units.hpp"
#include "fft/aligned.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::fft {

// As for windows of x: the longest for which sums are not slower with vectors of four numbers.
bool RowWindow::pays(std::ptrdiff_t ny, std::ptrdiff_t count) {
    return count > 0 && count < ny &&
           static_cast<double>(count) <= 8.0 * std::log2(static_cast<double>(ny));
}

RowWindow::RowWindow(std::ptrdiff_t ny, std::ptrdiff_t begin, std::ptrdiff_t count)
    : kernels_(simd::kernels<RowWindowKernels>()), begin_(begin), count_(count),
      mode_count_(ny / 2 + 1) {
    const std::ptrdiff_t distances = count / 2 + 1;
    const auto put = [&](AlignedVector<double>& to, std::ptrdiff_t ky, std::ptrdiff_t y) {
        // Reduced to one turn, so that the angle is exact for long rows.
        const double angle = two_pi * static_cast<double>(ky * y % ny) / static_cast<double>(ny);
        to.push_back(std::cos(angle));
        to.push_back(std::sin(angle));
    };
    for (std::ptrdiff_t ky = 0; ky < mode_count_; ++ky) {
        put(middle_, ky, begin + count / 2);
        weights_.push_back(ky == 0 || 2 * ky == ny ? 1.0 : 2.0);
        for (std::ptrdiff_t d = 0; d < distances; ++d)
            put(angles_, ky, d);
    }
    rows_.assign(static_cast<std::size_t>(count * window_rows), 0.0);
    modes_.assign(static_cast<std::size_t>(mode_count_ * window_rows), 0.0);
    scratch_.assign(static_cast<std::size_t>(2 * window_rows * std::max(distances, mode_count_)),
                    0.0);
}

RowWindowArrays RowWindow::arrays() const {
    return {.count = count_,
            .reach = count_ / 2,
            .modes = mode_count_,
            .angles = angles_.data(),
            .middle = middle_.data(),
            .weights = weights_.data()};
}

void RowWindow::clear_rows() {
    std::fill(rows_.begin(), rows_.end(), 0.0);
}

void RowWindow::to_modes() {
    kernels_.to_modes(arrays(), rows_.data(), reals(modes_.data()), scratch_.data());
}

void RowWindow::to_rows() {
    kernels_.to_rows(arrays(), reals(modes_.data()), rows_.data(), scratch_.data());
}

} // namespace shearwake::fft
