// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/acoustics/lens_design.hpp"

#include "base/units.hpp"
#include "fft/aligned.hpp"
#include "fft/line_transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace shearwake {

namespace {

using Complex = std::complex<double>;
using Lines = fft::AlignedVector<Complex>;

/// Transforms along both axes and transposes the result.
void transform(Lines& values, const fft::LineTransform& lines) {
    lines.execute(values.data());
    const std::ptrdiff_t side = lines.length();
    for (std::ptrdiff_t i = 0; i < side; ++i)
        for (std::ptrdiff_t j = i + 1; j < side; ++j)
            std::swap(values[static_cast<std::size_t>(i * side + j)],
                      values[static_cast<std::size_t>(j * side + i)]);
    lines.execute(values.data());
}

/// Nodes in [-1, 1] and weights of the Gauss rule of four points. Over a cell of a quarter of the
/// wavelength and half the distance to the other plane, its error is below 1e-6.
constexpr std::array<std::pair<double, double>, 4> gauss_rule = {
    {{-0.8611363115940526, 0.34785484513745385},
     {-0.3399810435848563, 0.6521451548625461},
     {0.3399810435848563, 0.6521451548625461},
     {0.8611363115940526, 0.34785484513745385}}};

/// The pressure of a cell of unit pressure at this offset from its centre.
Complex pressure_of_cell(const Sound& sound, const PlanePair& planes, double x_m, double y_m) {
    const Complex i_k(-sound.attenuation_Np_m, sound.wavenumber_rad_m);
    const double half_m = 0.5 * planes.spacing_m, z = planes.distance_m;
    Complex sum = 0.0;
    for (const auto& [x, x_weight] : gauss_rule)
        for (const auto& [y, y_weight] : gauss_rule) {
            const double r = std::hypot(x_m - half_m * x, y_m - half_m * y, z);
            sum += x_weight * y_weight * z / (r * r) * (1.0 / r - i_k) * std::exp(i_k * r);
        }
    return half_m * half_m / two_pi * sum;
}

} // namespace

struct PlanePropagation::Transforms {
    fft::LineTransform forward, backward;
    Lines work;
};

PlanePropagation::PlanePropagation(const Sound& sound, const PlanePair& planes)
    : side_(planes.side) {
    const auto points = static_cast<std::size_t>(side_ * side_);
    transforms_ = std::make_unique<Transforms>(
        Transforms{fft::LineTransform(side_, fft::Direction::forward, side_),
                   fft::LineTransform(side_, fft::Direction::backward, side_), Lines(points)});
    Lines& work = transforms_->work;
    const auto put = [&](std::ptrdiff_t i, std::ptrdiff_t j, Complex p) {
        for (const std::ptrdiff_t x : {i, (side_ - i) % side_})
            for (const std::ptrdiff_t y : {j, (side_ - j) % side_})
                work[static_cast<std::size_t>(x * side_ + y)] = p;
    };
    for (std::ptrdiff_t i = 0; 2 * i <= side_; ++i)
        for (std::ptrdiff_t j = 0; j <= i; ++j) {
            const Complex p =
                pressure_of_cell(sound, planes, planes.spacing_m * static_cast<double>(i),
                                 planes.spacing_m * static_cast<double>(j)) /
                static_cast<double>(points);
            put(i, j, p);
            put(j, i, p);
        }
    transform(work, transforms_->forward);
    factors_.assign(work.begin(), work.end());
}

PlanePropagation::~PlanePropagation() = default;
PlanePropagation::PlanePropagation(PlanePropagation&&) noexcept = default;
PlanePropagation& PlanePropagation::operator=(PlanePropagation&&) noexcept = default;

void PlanePropagation::apply(std::span<Complex> pressure, Direction direction) {
    Lines& work = transforms_->work;
    std::copy(pressure.begin(), pressure.end(), work.begin());
    transform(work, transforms_->forward);
    for (std::size_t n = 0; n < factors_.size(); ++n)
        work[n] *= direction == Direction::backward ? std::conj(factors_[n]) : factors_[n];
    transform(work, transforms_->backward);
    std::copy(work.begin(), work.end(), pressure.begin());
}

void PlanePropagation::forward(std::span<Complex> pressure) {
    apply(pressure, Direction::forward);
}

void PlanePropagation::adjoint(std::span<Complex> pressure) {
    apply(pressure, Direction::backward);
}

std::vector<double> refined(std::span<const double> samples, std::ptrdiff_t side,
                            std::ptrdiff_t factor) {
    const std::ptrdiff_t fine = factor * side;
    Lines coarse(samples.begin(), samples.end());
    transform(coarse, fft::LineTransform(side, fft::Direction::forward, side));
    Lines values(static_cast<std::size_t>(fine * fine));
    const auto to_fine = [&](std::ptrdiff_t index) {
        return 2 * index < side ? index : index + fine - side;
    };
    for (std::ptrdiff_t i = 0; i < side; ++i)
        for (std::ptrdiff_t j = 0; j < side; ++j)
            values[static_cast<std::size_t>(to_fine(i) * fine + to_fine(j))] =
                coarse[static_cast<std::size_t>(i * side + j)] / static_cast<double>(side * side);
    transform(values, fft::LineTransform(fine, fft::Direction::backward, fine));
    std::vector<double> real;
    for (const Complex& value : values)
        real.push_back(value.real());
    return real;
}

double air_absorption_dB_m(double frequency_Hz, double temperature_K, double humidity) {
    // ISO 9613-1, equations 3 to 5 and B.3, at the reference pressure.
    const double relative = temperature_K / 293.15;
    const double saturation = std::pow(10.0, -6.8346 * std::pow(273.16 / temperature_K, 1.261) +
                                                 4.6151); // partial pressure of water vapour
    const double water_percent = 100.0 * humidity * saturation;
    const double oxygen_Hz =
        24.0 + 4.04e4 * water_percent * (0.02 + water_percent) / (0.391 + water_percent);
    const double nitrogen_Hz =
        (9.0 + 280.0 * water_percent * std::exp(-4.170 * (std::cbrt(1.0 / relative) - 1.0))) /
        std::sqrt(relative);
    const double f2 = frequency_Hz * frequency_Hz;
    const auto relaxation = [&](double strength, double temperature, double at_Hz) {
        return strength * std::exp(-temperature / temperature_K) / (at_Hz + f2 / at_Hz);
    };
    return 8.686 * f2 *
           (1.84e-11 * std::sqrt(relative) +
            std::pow(relative, -2.5) *
                (relaxation(0.01275, 2239.1, oxygen_Hz) + relaxation(0.1068, 3352.0, nitrogen_Hz)));
}

} // namespace shearwake
