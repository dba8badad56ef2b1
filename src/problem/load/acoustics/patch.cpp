// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/acoustics/patch.hpp"

#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

using Complex = std::complex<double>;
/// The width of the fade-out divided by the reach, and its end: erfc(4.3) = 1e-9, applied to side
/// lobes of a hundredth of the peak.
constexpr double fading_width = 0.125;
constexpr double fading_end = 4.3;

double sinc(double x) {
    return std::abs(x) < 1e-9 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

} // namespace

double Patch::band_rad_m() const {
    return std::numbers::pi / spacing_m;
}

void transform_columns(const Patch& patch, double ky_rad_m, std::span<Complex> out) {
    std::vector<double> cosines, sines;
    for (std::ptrdiff_t j = 0; j < patch.side; ++j) {
        const double angle = ky_rad_m * static_cast<double>(j) * patch.spacing_m;
        cosines.push_back(std::cos(angle));
        sines.push_back(-std::sin(angle));
    }
    for (std::ptrdiff_t i = 0; i < patch.side; ++i) {
        const double* values = patch.values.data() + i * patch.side;
        double re = 0.0, im = 0.0;
        for (std::size_t j = 0; j < cosines.size(); ++j) {
            re += values[j] * cosines[j];
            im += values[j] * sines[j];
        }
        out[static_cast<std::size_t>(i)] = {re, im};
    }
}

Complex transform_row(const Patch& patch, double kx_rad_m, std::span<const Complex> columns) {
    Complex sum = 0.0;
    const Complex turn = std::polar(1.0, -kx_rad_m * patch.spacing_m);
    Complex phase = 1.0; // error grows by about 1e-16 per sample, over about a hundred samples
    for (const Complex& column : columns) {
        sum += column * phase;
        phase *= turn;
    }
    return patch.spacing_m * patch.spacing_m * sum;
}

Complex transform(const Patch& patch, double kx_rad_m, double ky_rad_m) {
    const double band = patch.band_rad_m();
    if (std::abs(kx_rad_m) > band || std::abs(ky_rad_m) > band) return 0.0;
    std::vector<Complex> columns(static_cast<std::size_t>(patch.side));
    transform_columns(patch, ky_rad_m, columns);
    return transform_row(patch, kx_rad_m, columns);
}

double value_at(const Patch& patch, Vec2 at_m) {
    const Vec2 index = (1.0 / patch.spacing_m) * (at_m - patch.origin_m);
    std::vector<double> along_y;
    for (std::ptrdiff_t j = 0; j < patch.side; ++j)
        along_y.push_back(sinc(index.y - static_cast<double>(j)));
    double sum = 0.0;
    for (std::ptrdiff_t i = 0; i < patch.side; ++i) {
        const double* values = patch.values.data() + i * patch.side;
        double column = 0.0;
        for (std::size_t j = 0; j < along_y.size(); ++j)
            column += values[j] * along_y[j];
        sum += column * sinc(index.x - static_cast<double>(i));
    }
    return sum;
}

double fading(double reach_m, double r_m) {
    return 0.5 * std::erfc((r_m - reach_m) / (fading_width * reach_m));
}

double fading_end_m(double reach_m) {
    return reach_m * (1.0 + fading_width * fading_end);
}

} // namespace shearwake
