// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/line_window.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

using namespace shearwake;

namespace {

using Complex = std::complex<double>;

/// Pseudo-random numbers in [-1, 1].
Complex noise(std::ptrdiff_t i, std::ptrdiff_t plane) {
    const auto x = static_cast<double>(i), y = static_cast<double>(plane);
    return {std::sin(12.9898 * x + 78.233 * y + 1.0), std::cos(3.1 * x + 5.7 * x * y)};
}

Complex turn(std::ptrdiff_t nx, std::ptrdiff_t k, std::ptrdiff_t x) {
    return std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(k * x) /
                               static_cast<double>(nx));
}

} // namespace

TEST_CASE("transforms of a window equal the Fourier sum without the Nyquist mode") {
    // Odd and even numbers of points, windows that wrap no block and several blocks of distances,
    // and lines that end within a block of wavenumbers.
    const std::ptrdiff_t nx = GENERATE(16, 30, 96);
    const std::ptrdiff_t count = GENERATE(1, 2, 9, 14, 16);
    const std::ptrdiff_t begin = GENERATE(0, 5);
    if (begin + count > nx) return;
    CAPTURE(nx, count, begin);
    constexpr std::ptrdiff_t planes = 3;
    spectral::LineWindow window(nx, begin, count);
    const auto size = [](std::ptrdiff_t n) { return static_cast<std::size_t>(n); };
    fft::AlignedVector<double> line(size(planes * 2 * nx)), points(size(planes * 2 * count));
    auto* modes = reinterpret_cast<Complex*>(line.data());
    auto* values = reinterpret_cast<Complex*>(points.data());
    const double tolerance = 1e-14 * static_cast<double>(nx); // rounding of nx terms

    for (std::ptrdiff_t p = 0; p < planes; ++p)
        for (std::ptrdiff_t k = 0; k < nx; ++k)
            modes[p * nx + k] = noise(k, p);
    window.to_window(planes, line.data(), 2 * nx, points.data(), 2 * count);
    for (std::ptrdiff_t p = 0; p < planes; ++p)
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            Complex sum = 0.0;
            for (std::ptrdiff_t k = 0; k < nx; ++k)
                if (2 * k != nx) sum += noise(k, p) * turn(nx, k, begin + i);
            CHECK(std::abs(values[p * count + i] - sum) < tolerance);
        }

    for (std::ptrdiff_t p = 0; p < planes; ++p)
        for (std::ptrdiff_t i = 0; i < count; ++i)
            values[p * count + i] = noise(i, p);
    window.to_line(planes, points.data(), 2 * count, line.data(), 2 * nx);
    for (std::ptrdiff_t p = 0; p < planes; ++p)
        for (std::ptrdiff_t k = 0; k < nx; ++k) {
            if (2 * k == nx) continue;
            Complex sum = 0.0;
            for (std::ptrdiff_t i = 0; i < count; ++i)
                sum += noise(i, p) * turn(nx, -k, begin + i);
            CHECK(std::abs(modes[p * nx + k] - sum) < tolerance);
        }
}
