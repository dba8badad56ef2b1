// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/load/load_spectrum.hpp"

#include "base/units.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;

} // namespace

LoadSpectrum::LoadSpectrum(const Case& c, const TimeTransform& time, std::ptrdiff_t ky_start,
                           std::ptrdiff_t ky_count, SteeredSpectra& steered, CaseProgress& progress)
    : kernels_(simd::kernels<ResponseKernels>()), nx_(c.domain.nx), ny_(c.domain.ny),
      samples_(time.samples), ky_start_(ky_start), ky_count_(ky_count),
      dkx_rad_m_(two_pi / c.domain.extent_x_m()), dky_rad_m_(two_pi / c.domain.extent_y_m()),
      nodes_(c, time), pattern_(c.scene.load, time.end_s(c.time)),
      forward_(time.samples, fft::Direction::forward), y_rests_(moves_along_x(c, time)),
      buffer_(nodes_.times_s().size()), steered_(steered) {
    for (std::ptrdiff_t kx = 0; kx < nx_; ++kx)
        kx_rad_m_.push_back(static_cast<double>(2 * kx < nx_ ? kx : kx - nx_) * dkx_rad_m_);
    const std::vector<double>& times_s = nodes_.times_s();
    const std::size_t n = times_s.size();
    for (std::size_t i = 0; i < n; ++i)
        weighted_.emplace_back(nodes_.weights()[i] * std::exp(-time.decay_rad_s * times_s[i]) *
                               strength(c.scene.load, times_s[i]));
    // Positions relative to the corner of the grid, where the transform has its origin.
    std::vector<Vec2> origin = origins_of_times(c, time.end_s(c.time), progress);
    for (Vec2& place : origin)
        place = place - Vec2{c.domain.x_m(0), c.domain.y_m(0)};

    const std::size_t jumps_per_line =
        static_cast<std::size_t>(jump_orders) * nodes_.breaks().size();
    const auto stored = y_rests_ ? static_cast<std::size_t>(samples_) : n;
    x_phases_.resize(static_cast<std::size_t>(nx_) * stored);
    jumps_.resize((y_rests_ ? static_cast<std::size_t>(nx_) : 1) * jumps_per_line);
    for (std::size_t i = 0; i < static_cast<std::size_t>(nx_); ++i) {
        Complex* line = y_rests_ ? buffer_.data() : x_phases_.data() + i * stored;
        for (std::size_t t = 0; t < n; ++t)
            line[t] = weighted_[t] * std::polar(1.0, -kx_rad_m_[i] * origin[t].x);
        if (!y_rests_) continue;
        transform(line, jumps_.data() + i * jumps_per_line);
        std::copy_n(line, stored, x_phases_.data() + i * stored);
    }
    const auto modes = static_cast<std::size_t>(ny_ / 2 + 1);
    for (std::size_t j = 0; j < modes; ++j)
        for (std::size_t t = 0; t < (y_rests_ ? 1 : n); ++t)
            y_phases_.push_back(
                std::polar(1.0, -static_cast<double>(j) * dky_rad_m_ * origin[t].y));
}

/// Reduces the values at the times of nodes_ to the spectrum of the samples and to the jumps.
void LoadSpectrum::transform(Complex* values, Complex* jumps_of_line) const {
    const Complex* at_nodes = values + samples_;
    const Complex* near_breaks = at_nodes + nodes_.nodes();
    kernels_.distribute(fft::reals(at_nodes), nodes_.coefficients().data(),
                        nodes_.first_samples().data(), nodes_.nodes(), taps, fft::reals(values),
                        samples_);
    for (std::ptrdiff_t b = 0; b < std::ssize(nodes_.breaks()); ++b)
        std::ranges::copy(jumps(near_breaks + 2 * jump_orders * b),
                          jumps_of_line + jump_orders * b);
    forward_.execute(values);
}

bool LoadSpectrum::moves_along_x(const Case& c, const TimeTransform& time) {
    const Load& load = c.scene.load;
    if (std::holds_alternative<ArrayFootprint>(load.footprint) &&
        greatest_speed_m_s(load.modulation.trajectory) > 0.0)
        return false; // before its field is tabulated
    LoadPattern pattern(c.scene.load, time.end_s(c.time));
    if (pattern.changes()) return false;
    const auto y_m = [&](std::ptrdiff_t sample) {
        pattern.set(pattern.updated_s(time.sample_s(sample)));
        return pattern.origin_m().y;
    };
    const double first_m = y_m(0);
    for (std::ptrdiff_t i = 1; i < time.samples; ++i)
        if (y_m(i) != first_m) return false;
    return true;
}

/// Also computes the states of a changing pattern.
std::vector<Vec2> LoadSpectrum::origins_of_times(const Case& c, double end_s,
                                                 CaseProgress& progress) {
    std::vector<Vec2> origins;
    std::vector<double> updated_s;
    for (const double t_s : nodes_.times_s())
        updated_s.push_back(pattern_.updated_s(std::max(t_s, 0.0)));
    if (!pattern_.changes()) {
        steered_ = {};
        for (const double at_s : updated_s) {
            pattern_.set(at_s);
            origins.push_back(pattern_.origin_m());
        }
        return origins;
    }
    const Modulation& modulation = c.scene.load.modulation;
    SteeredSpectra::Key key{.footprint = c.scene.load.footprint,
                            .trajectory = modulation.trajectory,
                            .foci_m = modulation.foci_m,
                            .times_s = std::move(updated_s),
                            .end_s = end_s,
                            .dkx_rad_m = dkx_rad_m_,
                            .dky_rad_m = dky_rad_m_,
                            .nx = nx_,
                            .ny = ny_,
                            .ky_start = ky_start_,
                            .ky_count = ky_count_};
    if (steered_.key != key) compute_steered(std::move(key), progress);
    for (const std::size_t state : steered_.state_of)
        origins.push_back(steered_.origins_m[state]);
    return origins;
}

void LoadSpectrum::compute_steered(SteeredSpectra::Key key, CaseProgress& progress) {
    steered_ = {};               // also its key, until all spectra are complete
    std::vector<double> state_s; // a time of each state
    std::map<std::pair<double, double>, std::size_t> states;
    for (const double at_s : key.times_s) {
        const Vec2 place = position(key.trajectory, at_s);
        const auto [state, is_new] = states.try_emplace({place.x, place.y}, state_s.size());
        if (is_new) state_s.push_back(at_s);
        steered_.state_of.push_back(state->second);
    }
    const auto last = [&](double dk, std::ptrdiff_t nyquist) {
        return std::min(nyquist - 1, static_cast<std::ptrdiff_t>(pattern_.band_rad_m() / dk));
    };
    steered_.last_kx = last(dkx_rad_m_, nx_ / 2);
    steered_.rows =
        std::clamp<std::ptrdiff_t>(last(dky_rad_m_, ny_ / 2) + 1 - ky_start_, 0, ky_count_);
    const std::ptrdiff_t width = 2 * steered_.last_kx + 1;
    steered_.values.resize(static_cast<std::size_t>(steered_.rows * width) * state_s.size());
    std::vector<double> kx;
    for (std::ptrdiff_t mode = -steered_.last_kx; mode <= steered_.last_kx; ++mode)
        kx.push_back(static_cast<double>(mode) * dkx_rad_m_);
    std::vector<Complex> spectra(kx.size());
    for (std::size_t s = 0; s < state_s.size(); ++s) {
        progress.end_if_asked();
        pattern_.set(state_s[s]);
        steered_.origins_m.push_back(pattern_.origin_m());
        for (std::ptrdiff_t row = 0; row < steered_.rows; ++row) {
            pattern_.spectra(static_cast<double>(ky_start_ + row) * dky_rad_m_, kx, spectra);
            for (std::ptrdiff_t i = 0; i < width; ++i)
                steered_.values[static_cast<std::size_t>(row * width + i) * state_s.size() + s] =
                    spectra[static_cast<std::size_t>(i)];
        }
    }
    steered_.key = std::move(key);
}

void LoadSpectrum::factors(std::ptrdiff_t ky, std::span<Complex> out) const {
    if (pattern_.changes()) {
        const bool is_row_there = ky - ky_start_ < steered_.rows;
        for (std::ptrdiff_t kx = 0; kx < nx_; ++kx) {
            const std::ptrdiff_t mode = 2 * kx < nx_ ? kx : kx - nx_;
            out[static_cast<std::size_t>(kx)] =
                is_row_there && std::abs(mode) <= steered_.last_kx ? 1.0 : 0.0;
        }
        return;
    }
    pattern_.spectra(static_cast<double>(ky) * dky_rad_m_, kx_rad_m_, out);
    if (!y_rests_) return;
    for (Complex& factor : out)
        factor *= y_phases_[static_cast<std::size_t>(ky)];
}

double LoadSpectrum::memory_B(const Case& c, const TimeTransform& time, std::ptrdiff_t ky_count) {
    const LoadPattern pattern(c.scene.load, time.end_s(c.time));
    if (!pattern.changes()) return 0.0;
    const auto modes = [&](double extent_m, double most) {
        return std::min(most, pattern.band_rad_m() / two_pi * extent_m + 1.0);
    };
    const double states = std::ceil(c.time.duration_s() / time.step_s) + 1.0;
    return sizeof(Complex) * states * modes(c.domain.extent_y_m(), static_cast<double>(ky_count)) *
           2.0 * modes(c.domain.extent_x_m(), 0.5 * static_cast<double>(c.domain.nx));
}

LoadSpectrum::Line LoadSpectrum::line(std::ptrdiff_t kx, std::ptrdiff_t ky) {
    const auto n = static_cast<std::size_t>(samples_), row = static_cast<std::size_t>(kx);
    const std::size_t jumps_per_line =
        static_cast<std::size_t>(jump_orders) * nodes_.breaks().size();
    if (y_rests_)
        return {{x_phases_.data() + row * n, n},
                std::span(jumps_).subspan(row * jumps_per_line, jumps_per_line)};
    const std::size_t times = buffer_.size();
    kernels_.multiply(fft::reals(x_phases_.data() + row * times),
                      fft::reals(y_phases_.data() + static_cast<std::size_t>(ky) * times),
                      static_cast<std::ptrdiff_t>(times), fft::reals(buffer_.data()));
    if (pattern_.changes()) {
        const std::ptrdiff_t mode = 2 * kx < nx_ ? kx : kx - nx_;
        const std::ptrdiff_t at =
            (ky - ky_start_) * (2 * steered_.last_kx + 1) + mode + steered_.last_kx;
        const Complex* g =
            steered_.values.data() + static_cast<std::size_t>(at) * steered_.origins_m.size();
        for (std::size_t t = 0; t < times; ++t)
            buffer_[t] *= g[steered_.state_of[t]];
    }
    transform(buffer_.data(), jumps_.data());
    return {{buffer_.data(), n}, jumps_};
}

} // namespace shearwake::layered
