// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/line_window.hpp"

#include "base/units.hpp"
#include "simd/kernels.hpp"

#include <cmath>

namespace shearwake::spectral {
namespace {

std::ptrdiff_t blocks_of(std::ptrdiff_t count) {
    return (count + lane_count - 1) / lane_count;
}

} // namespace

// Measured with 256 points: an FFT takes as long as a window of some 100 points with vectors of
// eight numbers and half as many with four.
bool LineWindow::pays(std::ptrdiff_t nx, std::ptrdiff_t count) {
    return count > 0 && static_cast<double>(count) <= 8.0 * std::log2(static_cast<double>(nx));
}

LineWindow::LineWindow(std::ptrdiff_t nx, std::ptrdiff_t begin, std::ptrdiff_t count)
    : kernels_(simd::kernels<WindowKernels>()), nx_(nx), begin_(begin), count_(count) {
    const std::ptrdiff_t half = nx / 2, modes = paired(nx) + 1, distances = count / 2 + 1;
    const auto size = [](std::ptrdiff_t n) { return static_cast<std::size_t>(n); };
    by_distance_.assign(size(blocks_of(distances - 1) * modes), Turn{});
    by_kx_.assign(size(blocks_of(paired(nx)) * distances), Turn{});
    of_middle_.assign(size(blocks_of(half)), Turn{});
    const auto put = [&](Turn& turn, std::ptrdiff_t lane, std::ptrdiff_t k, std::ptrdiff_t x,
                         double weight) {
        // Reduced to one turn, so that the angle is exact for long lines.
        const double angle = two_pi * static_cast<double>(k * x % nx) / static_cast<double>(nx);
        turn.cosine[lane] = weight * std::cos(angle);
        turn.sine[lane] = weight * std::sin(angle);
    };
    for (std::ptrdiff_t k = 0; k < half; ++k)
        put(of_middle_[size(k / lane_count)], k % lane_count, k, begin + count / 2, 1.0);
    for (std::ptrdiff_t d = 1; d < distances; ++d)
        for (std::ptrdiff_t k = 0; k < modes; ++k)
            put(by_distance_[size((d - 1) / lane_count * modes + k)], (d - 1) % lane_count, k, d,
                k == 0 || 2 * k == half ? 0.5 : 1.0);
    for (std::ptrdiff_t k = 0; k < blocks_of(paired(nx)) * lane_count; ++k)
        for (std::ptrdiff_t d = 0; d < distances; ++d)
            put(by_kx_[size(k / lane_count * distances + d)], k % lane_count, k, d, 1.0);
}

WindowArrays LineWindow::arrays() const {
    return {.nx = nx_,
            .count = count_,
            .reach = count_ / 2,
            .by_distance = by_distance_.data(),
            .by_kx = by_kx_.data()};
}

void LineWindow::to_window(std::ptrdiff_t planes, const double* line, std::ptrdiff_t line_stride,
                           double* window, std::ptrdiff_t window_stride) {
    kernels_.to_window(arrays(), planes, line, line_stride, window, window_stride,
                       scratch(2 * folds * (paired(nx_) + 1)));
}

void LineWindow::to_line(std::ptrdiff_t planes, const double* window, std::ptrdiff_t window_stride,
                         double* line, std::ptrdiff_t line_stride) {
    kernels_.to_line(arrays(), planes, window, window_stride, line, line_stride,
                     scratch(planes * folds * (count_ / 2 + 1)));
}

double* LineWindow::scratch(std::ptrdiff_t size) {
    const auto needed = static_cast<std::size_t>(size);
    if (scratch_.size() < needed) scratch_.resize(needed);
    return scratch_.data();
}

} // namespace shearwake::spectral
