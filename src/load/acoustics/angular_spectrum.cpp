// SPDX-License-Identifier: BSD-3-Clause
#include "load/acoustics/angular_spectrum.hpp"

#include "fft/aligned.hpp"
#include "fft/line_transform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

using Complex = std::complex<double>;
using Lines = fft::AlignedVector<Complex>;

void transpose(Complex* values, std::ptrdiff_t side) {
    for (std::ptrdiff_t i = 0; i < side; ++i)
        for (std::ptrdiff_t j = i + 1; j < side; ++j)
            std::swap(values[i * side + j], values[j * side + i]);
}

/// Index of a frequency in FFT order, as a signed number.
double frequency(std::ptrdiff_t index, std::ptrdiff_t side) {
    return static_cast<double>(2 * index < side ? index : index - side);
}

/// cos^2 from 1 at `from` to 0 at `to`.
double taper(double x, double from, double to) {
    const double share = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return std::pow(std::cos(0.5 * std::numbers::pi * share), 2);
}

} // namespace

struct AngularSpectrum::Transforms {
    fft::LineTransform forward, backward;
    Lines work;
};

AngularSpectrum::AngularSpectrum(const Sound& sound, const PlanePair& planes) : side_(planes.side) {
    const auto points = static_cast<std::size_t>(side_ * side_);
    transforms_ = std::make_unique<Transforms>(
        Transforms{fft::LineTransform(side_, fft::Direction::forward, side_),
                   fft::LineTransform(side_, fft::Direction::backward, side_), Lines(points)});
    const double period_m = static_cast<double>(side_) * planes.spacing_m;
    const double dk = 2.0 * std::numbers::pi / period_m;
    const Complex k(sound.wavenumber_rad_m, sound.attenuation_Np_m);
    factors_.resize(points);
    for (std::ptrdiff_t i = 0; i < side_; ++i)
        for (std::ptrdiff_t j = 0; j < side_; ++j) {
            const double lateral = dk * std::hypot(frequency(i, side_), frequency(j, side_));
            if (lateral >= sound.wavenumber_rad_m) continue; // evanescent
            const Complex kz = std::sqrt(k * k - lateral * lateral);
            const double offset_m = planes.distance_m * lateral / kz.real();
            factors_[static_cast<std::size_t>(i * side_ + j)] =
                taper(offset_m, planes.offset_m, period_m - planes.offset_m) *
                std::exp(Complex(0.0, 1.0) * kz * planes.distance_m) / static_cast<double>(points);
        }
}

AngularSpectrum::~AngularSpectrum() = default;
AngularSpectrum::AngularSpectrum(AngularSpectrum&&) noexcept = default;
AngularSpectrum& AngularSpectrum::operator=(AngularSpectrum&&) noexcept = default;

void AngularSpectrum::apply(std::span<Complex> pressure, Way way) {
    Lines& work = transforms_->work;
    std::copy(pressure.begin(), pressure.end(), work.begin());
    transforms_->forward.execute(work.data());
    transpose(work.data(), side_);
    transforms_->forward.execute(work.data());
    for (std::size_t n = 0; n < factors_.size(); ++n)
        work[n] *= way == Way::back ? std::conj(factors_[n]) : factors_[n];
    transforms_->backward.execute(work.data());
    transpose(work.data(), side_);
    transforms_->backward.execute(work.data());
    std::copy(work.begin(), work.end(), pressure.begin());
}

void AngularSpectrum::forward(std::span<Complex> pressure) {
    apply(pressure, Way::there);
}

void AngularSpectrum::adjoint(std::span<Complex> pressure) {
    apply(pressure, Way::back);
}

std::vector<Complex> refined(std::span<const Complex> samples, std::ptrdiff_t side,
                             std::ptrdiff_t factor) {
    const std::ptrdiff_t fine = factor * side;
    Lines coarse(samples.begin(), samples.end());
    const fft::LineTransform forward(side, fft::Direction::forward, side);
    forward.execute(coarse.data());
    transpose(coarse.data(), side);
    forward.execute(coarse.data());
    Lines values(static_cast<std::size_t>(fine * fine));
    const auto to_fine = [&](std::ptrdiff_t index) {
        return 2 * index < side ? index : index + fine - side;
    };
    for (std::ptrdiff_t i = 0; i < side; ++i)
        for (std::ptrdiff_t j = 0; j < side; ++j)
            values[static_cast<std::size_t>(to_fine(i) * fine + to_fine(j))] =
                coarse[static_cast<std::size_t>(i * side + j)] / static_cast<double>(side * side);
    const fft::LineTransform backward(fine, fft::Direction::backward, fine);
    backward.execute(values.data());
    transpose(values.data(), fine);
    backward.execute(values.data());
    return {values.begin(), values.end()};
}

} // namespace shearwake
