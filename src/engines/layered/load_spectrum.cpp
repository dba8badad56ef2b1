// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/load_spectrum.hpp"

#include "base/constants.hpp"
#include "engines/layered/work_kinds.hpp"

#include "simd/kernels.hpp"
#include "fft/reals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;

/// The part before `end` of the integral of the hat function of half-width `step` around t.
double covered(double t, double step, double end) {
    const double x = std::clamp((end - t) / step, -1.0, 1.0);
    return x < 0.0 ? 0.5 * (1.0 + x) * (1.0 + x) : 1.0 - 0.5 * (1.0 - x) * (1.0 - x);
}

double band_Hz(const Load& load) {
    double carrier = 0.0;
    if (const auto* resolved = std::get_if<ResolvedCarrier>(&load.carrier))
        carrier = resolved->frequency_Hz;
    const double scan = bandwidth_rad_m(load.footprint, 1e-6) *
                        greatest_speed_m_s(load.modulation.trajectory) / two_pi;
    // A focus that is updated at the rate of the array moves in jumps, which have content slightly
    // above that rate.
    const auto* array = std::get_if<ArrayFootprint>(&load.footprint);
    const double update = array && scan > 0.0 ? array->update_rate_Hz : 0.0;
    return scan + greatest_envelope_frequency_Hz(load.modulation.envelope) + carrier + update;
}

} // namespace

TimeTransform time_transform(const Case& c, const LayeredOptions& options) {
    double longest_step_s = 1.0 / (2.5 * std::max(band_Hz(c.scene().load), 1.0));
    if (options.time_step_s) longest_step_s = *options.time_step_s;
    const double ratio = c.time.interval_s / longest_step_s;
    const auto per_frame =
        std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(std::ceil(ratio - 1e-9)));
    TimeTransform time;
    if (c.time.regime == Regime::periodic) {
        time.samples = c.time.frames * per_frame;
        time.step_s = c.time.interval_s / static_cast<double>(per_frame);
        time.first_s = c.time.interval_s;
        return time;
    }
    const std::ptrdiff_t coarse = good_even_length(static_cast<std::ptrdiff_t>(
        std::ceil(options.window_factor * static_cast<double>(c.time.frames))));
    time.samples = coarse * per_frame;
    time.step_s = c.time.interval_s / static_cast<double>(per_frame);
    time.decay_rad_s =
        std::log(options.wrap_suppression) / (static_cast<double>(time.samples) * time.step_s);
    return time;
}

std::ptrdiff_t samples_per_frame(const Case& c, const TimeTransform& time) {
    return static_cast<std::ptrdiff_t>(std::llround(c.time.interval_s / time.step_s));
}

std::vector<double> sample_weights(const Case& c, const TimeTransform& time) {
    std::vector<double> weights(static_cast<std::size_t>(time.samples), 1.0);
    if (c.time.regime == Regime::periodic) return weights;
    const double gregory[] = {3.0 / 8.0, 7.0 / 6.0, 23.0 / 24.0};
    for (std::size_t i = 0; i < std::min<std::size_t>(3, weights.size()); ++i)
        weights[i] = gregory[i];
    const double duration_s = c.time.duration_s();
    const double period_s = static_cast<double>(time.samples) * time.step_s;
    const double taper_s = 0.5 * (period_s - duration_s);
    const double off_s = off_time_s(c.scene().load.modulation.trajectory);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double t = static_cast<double>(i) * time.step_s;
        if (off_s < duration_s - 0.5 * time.step_s) weights[i] *= covered(t, time.step_s, off_s);
        if (t > duration_s) {
            const double x = std::min(1.0, (t - duration_s) / taper_s);
            weights[i] *= std::pow(std::cos(0.5 * std::numbers::pi * x), 2);
        }
    }
    return weights;
}

std::vector<double> roll_off(const TimeTransform& time) {
    std::vector<double> factors(static_cast<std::size_t>(time.samples));
    for (std::ptrdiff_t m = 0; m < time.samples; ++m) {
        const auto nearest = static_cast<double>(std::min(m, time.samples - m));
        const double of_highest = nearest / (0.5 * static_cast<double>(time.samples));
        const double x = std::clamp((of_highest - 0.8) / 0.2, 0.0, 1.0);
        factors[static_cast<std::size_t>(m)] = std::pow(std::cos(0.5 * std::numbers::pi * x), 2);
    }
    return factors;
}

LoadSpectrum::LoadSpectrum(const Case& c, const TimeTransform& time, std::ptrdiff_t ky_start,
                           std::ptrdiff_t ky_count)
    : kernels_(simd::kernels<ResponseKernels>()), nx_(c.domain.nx), ny_(c.domain.ny),
      samples_(time.samples), ky_start_(ky_start), ky_count_(ky_count),
      dkx_rad_m_(two_pi / c.domain.extent_x_m()), dky_rad_m_(two_pi / c.domain.extent_y_m()),
      pattern_(c.scene().load, time.end_s(c.time)), forward_(time.samples, fft::Direction::forward),
      y_rests_(keeps_y(c, time)), weighted_(static_cast<std::size_t>(time.samples)),
      buffer_(static_cast<std::size_t>(time.samples)) {
    for (std::ptrdiff_t kx = 0; kx < nx_; ++kx)
        kx_rad_m_.push_back(static_cast<double>(2 * kx < nx_ ? kx : kx - nx_) * dkx_rad_m_);
    const auto n = static_cast<std::size_t>(samples_);
    const std::vector<double> weights = sample_weights(c, time);
    for (std::size_t i = 0; i < n; ++i) {
        const double t = time.sample_s(static_cast<std::ptrdiff_t>(i));
        weighted_[i] = weights[i] * std::exp(-time.decay_rad_s * t) * amplitude(c.scene().load, t);
    }
    // Positions relative to the corner of the grid, where the transform has its origin.
    std::vector<Vec2> origin = origins_of_samples(c, time);
    for (Vec2& place : origin)
        place = place - Vec2{c.domain.x_m(0), c.domain.y_m(0)};

    x_phases_.resize(static_cast<std::size_t>(nx_) * n);
    for (std::ptrdiff_t i = 0; i < nx_; ++i) {
        Complex* line = x_phases_.data() + static_cast<std::size_t>(i) * n;
        const double kx = kx_rad_m_[static_cast<std::size_t>(i)];
        for (std::size_t t = 0; t < n; ++t)
            line[t] = weighted_[t] * std::polar(1.0, -kx * origin[t].x);
        if (y_rests_) forward_.execute(line);
    }
    const auto modes = static_cast<std::size_t>(ny_ / 2 + 1);
    for (std::size_t j = 0; j < modes; ++j)
        for (std::size_t t = 0; t < (y_rests_ ? 1 : n); ++t)
            y_phases_.push_back(
                std::polar(1.0, -static_cast<double>(j) * dky_rad_m_ * origin[t].y));
}

bool LoadSpectrum::keeps_y(const Case& c, const TimeTransform& time) {
    LoadPattern pattern(c.scene().load, time.end_s(c.time));
    if (pattern.changes()) return false;
    const auto y_m = [&](std::ptrdiff_t sample) {
        pattern.set(pattern.held_s(time.sample_s(sample)));
        return pattern.origin_m().y;
    };
    const double first_m = y_m(0);
    for (std::ptrdiff_t i = 1; i < time.samples; ++i)
        if (y_m(i) != first_m) return false;
    return true;
}

/// Also computes the states of a changing pattern.
std::vector<Vec2> LoadSpectrum::origins_of_samples(const Case& c, const TimeTransform& time) {
    std::vector<Vec2> origins;
    std::vector<double> held_s; // time at which each state begins
    for (std::ptrdiff_t i = 0; i < samples_; ++i) {
        const double at_s = pattern_.held_s(time.sample_s(i));
        if (!pattern_.changes()) {
            pattern_.set(at_s);
            origins.push_back(pattern_.origin_m());
            continue;
        }
        const Trajectory& trajectory = c.scene().load.modulation.trajectory;
        if (held_s.empty() || position(trajectory, at_s) != position(trajectory, held_s.back()))
            held_s.push_back(at_s);
        state_of_.push_back(held_s.size() - 1);
    }
    if (!pattern_.changes()) return origins;
    const auto last = [&](double dk, std::ptrdiff_t nyquist) {
        return std::min(nyquist - 1, static_cast<std::ptrdiff_t>(pattern_.band_rad_m() / dk));
    };
    last_kx_ = last(dkx_rad_m_, nx_ / 2);
    rows_there_ =
        std::clamp<std::ptrdiff_t>(last(dky_rad_m_, ny_ / 2) + 1 - ky_start_, 0, ky_count_);
    states_ = held_s.size();
    const std::ptrdiff_t width = 2 * last_kx_ + 1;
    changing_.resize(static_cast<std::size_t>(rows_there_ * width) * states_);
    std::vector<double> kx;
    for (std::ptrdiff_t mode = -last_kx_; mode <= last_kx_; ++mode)
        kx.push_back(static_cast<double>(mode) * dkx_rad_m_);
    std::vector<Complex> spectra(kx.size());
    std::vector<Vec2> of_states;
    for (std::size_t s = 0; s < states_; ++s) {
        pattern_.set(held_s[s]);
        of_states.push_back(pattern_.origin_m());
        for (std::ptrdiff_t row = 0; row < rows_there_; ++row) {
            pattern_.spectra(static_cast<double>(ky_start_ + row) * dky_rad_m_, kx, spectra);
            for (std::ptrdiff_t i = 0; i < width; ++i)
                changing_[static_cast<std::size_t>(row * width + i) * states_ + s] =
                    spectra[static_cast<std::size_t>(i)];
        }
    }
    for (const std::size_t s : state_of_)
        origins.push_back(of_states[s]);
    return origins;
}

void LoadSpectrum::factors(std::ptrdiff_t ky, std::span<Complex> out) const {
    if (pattern_.changes()) {
        const bool is_row_there = ky - ky_start_ < rows_there_;
        for (std::ptrdiff_t kx = 0; kx < nx_; ++kx) {
            const std::ptrdiff_t mode = 2 * kx < nx_ ? kx : kx - nx_;
            out[static_cast<std::size_t>(kx)] =
                is_row_there && std::abs(mode) <= last_kx_ ? 1.0 : 0.0;
        }
        return;
    }
    pattern_.spectra(static_cast<double>(ky) * dky_rad_m_, kx_rad_m_, out);
    if (!y_rests_) return;
    for (Complex& factor : out)
        factor *= y_phases_[static_cast<std::size_t>(ky)];
}

double LoadSpectrum::memory_B(const Case& c, const TimeTransform& time, std::ptrdiff_t ky_count) {
    const LoadPattern pattern(c.scene().load, time.end_s(c.time));
    if (!pattern.changes()) return 0.0;
    const auto modes = [&](double extent_m, double most) {
        return std::min(most, pattern.band_rad_m() / two_pi * extent_m + 1.0);
    };
    const double states = std::ceil(c.time.duration_s() / time.step_s) + 1.0;
    return sizeof(Complex) * states * modes(c.domain.extent_y_m(), static_cast<double>(ky_count)) *
           2.0 * modes(c.domain.extent_x_m(), 0.5 * static_cast<double>(c.domain.nx));
}

std::span<const Complex> LoadSpectrum::line(std::ptrdiff_t kx, std::ptrdiff_t ky) {
    const auto n = static_cast<std::size_t>(samples_);
    const Complex* x = x_phases_.data() + static_cast<std::size_t>(kx) * n;
    if (y_rests_) return {x, n};
    const engines::Timed timed(kinds::of_load);
    const Complex* y = y_phases_.data() + static_cast<std::size_t>(ky) * n;
    kernels_.multiply(fft::reals(x), fft::reals(y), samples_, fft::reals(buffer_.data()));
    if (pattern_.changes()) {
        const std::ptrdiff_t mode = 2 * kx < nx_ ? kx : kx - nx_;
        const std::ptrdiff_t at = (ky - ky_start_) * (2 * last_kx_ + 1) + mode + last_kx_;
        const Complex* g = changing_.data() + static_cast<std::size_t>(at) * states_;
        for (std::size_t t = 0; t < n; ++t)
            buffer_[t] *= g[state_of_[t]];
    }
    forward_.execute(buffer_.data());
    return buffer_;
}

} // namespace shearwake::layered
