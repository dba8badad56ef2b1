// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/strain_planes.hpp"
#include "simd/kernels.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>

namespace test_line_window {

using namespace shearwake;

using Complex = std::complex<double>;

/// Pseudo-random numbers in [-1, 1].
static Complex noise(std::ptrdiff_t i, std::ptrdiff_t plane) {
    const auto x = static_cast<double>(i), y = static_cast<double>(plane);
    return {std::sin(12.9898 * x + 78.233 * y + 1.0), std::cos(3.1 * x + 5.7 * x * y)};
}

static Complex turn(std::ptrdiff_t nx, std::ptrdiff_t k, std::ptrdiff_t x) {
    return std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(k * x) /
                               static_cast<double>(nx));
}

/// A line in the format of a window: writes modes(k) of all kx to it, and reads them back.
class FoldedLine {
public:
    FoldedLine(const spectral::LineWindow& window, std::ptrdiff_t nx, double* line)
        : window_(window), nx_(nx), line_(line) {}

    template <class Modes>
    void put(const Modes& modes) const {
        each_block([&](const spectral::WaveBlock& waves) {
            Block parts[spectral::parts] = {};
            each_kx(waves, [&](std::ptrdiff_t k, std::ptrdiff_t lane) {
                const Complex plus = modes(k), minus = modes((nx_ - k) % nx_);
                parts[0][lane] = plus.real(), parts[1][lane] = plus.imag();
                parts[2][lane] = minus.real(), parts[3][lane] = minus.imag();
            });
            kernels_.put(waves, {}, parts, line_);
        });
    }
    /// Calls use(k, F(k)).
    template <class Use>
    void take(const Use& use) const {
        each_block([&](const spectral::WaveBlock& waves) {
            Block parts[spectral::parts] = {};
            kernels_.gather(waves, {}, line_, parts);
            each_kx(waves, [&](std::ptrdiff_t k, std::ptrdiff_t lane) {
                use(k, Complex{parts[0][lane], parts[1][lane]});
                if (k > 0) use(nx_ - k, Complex{parts[2][lane], parts[3][lane]});
            });
            for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
                if (2 * (waves.first + lane) >= nx_)
                    for (const Block& part : parts)
                        CHECK(part[lane] == 0.0); // wave vectors that do not exist
        });
    }

private:
    template <class Use>
    void each_block(const Use& use) const {
        for (std::ptrdiff_t first = 0; 2 * first < nx_; first += lane_count)
            use(window_.folded({.kx = {}, .k = {}, .ky = 0.0, .first = first, .nx = nx_}));
    }
    template <class Use>
    void each_kx(const spectral::WaveBlock& waves, const Use& use) const {
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
            if (2 * (waves.first + lane) < nx_) use(waves.first + lane, lane);
    }
    const spectral::LineKernels& kernels_ = simd::kernels<spectral::LineKernels>();
    const spectral::LineWindow& window_;
    std::ptrdiff_t nx_;
    double* line_;
};

TEST_CASE("transforms of a window equal the Fourier sum without the Nyquist mode") {
    // Odd and even numbers of points, windows within one block and with several groups of
    // distances, and lines that end within a block of wavenumbers.
    const std::ptrdiff_t nx = GENERATE(16, 30, 96);
    const std::ptrdiff_t count = GENERATE(1, 2, 9, 14, 16, 17, 19, 60);
    const std::ptrdiff_t begin = GENERATE(0, 5);
    if (begin + count > nx) return;
    CAPTURE(nx, count, begin);
    constexpr std::ptrdiff_t planes = 3;
    spectral::LineWindow window(nx, begin, count);
    const auto size = [](std::ptrdiff_t n) { return static_cast<std::size_t>(n); };
    const std::ptrdiff_t stride = window.line_reals();
    fft::AlignedVector<double> line(size(planes * stride)), points(size(planes * 2 * count));
    auto* values = reinterpret_cast<Complex*>(points.data());
    const double tolerance = 1e-14 * static_cast<double>(nx); // rounding of nx terms

    for (std::ptrdiff_t p = 0; p < planes; ++p)
        FoldedLine(window, nx, line.data() + p * stride).put([&](std::ptrdiff_t k) {
            return noise(k, p);
        });
    window.to_window(planes, line.data(), stride, points.data(), 2 * count);
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
    window.to_line(planes, points.data(), 2 * count, line.data(), stride);
    for (std::ptrdiff_t p = 0; p < planes; ++p)
        FoldedLine(window, nx, line.data() + p * stride).take([&](std::ptrdiff_t k, Complex found) {
            Complex sum = 0.0;
            for (std::ptrdiff_t i = 0; i < count; ++i)
                sum += noise(i, p) * turn(nx, -k, begin + i);
            CHECK(std::abs(found - sum) < tolerance);
        });
}

} // namespace test_line_window
