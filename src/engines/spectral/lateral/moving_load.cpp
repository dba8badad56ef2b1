// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/moving_load.hpp"

#include "base/constants.hpp"
#include "simd/kernels.hpp"
#include "fft/reals.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::spectral {
namespace {

using Complex = std::complex<double>;

/// Times (in steps) of the load samples that contribute to a step, and their weights.
struct Sample {
    std::ptrdiff_t step;
    double weight;
};
std::array<Sample, 3> samples_at(std::ptrdiff_t n) {
    if (n == 0) return {{{0, 7.0 / 12.0}, {1, 0.5}, {2, -1.0 / 12.0}}};
    return {{{n - 1, 1.0 / 12.0}, {n, 10.0 / 12.0}, {n + 1, 1.0 / 12.0}}};
}

} // namespace

WaveVectors WaveVectors::coarser(std::ptrdiff_t nx, std::ptrdiff_t ny) const {
    WaveVectors some = *this;
    some.nx_ = nx;
    some.ny_ = ny;
    some.share_.ky_start = std::min(share_.ky_start, ny / 2 + 1);
    some.share_.ky_count = std::min(share_.ky_count, ny / 2 + 1 - some.share_.ky_start);
    return some;
}

double WaveVectors::kx_rad_m(std::ptrdiff_t i) const {
    return two_pi / extent_x_m_ * static_cast<double>(i);
}

double WaveVectors::ky_rad_m(std::ptrdiff_t row) const {
    return two_pi / extent_y_m_ * static_cast<double>(share_.ky_start + row);
}

WaveBlock WaveVectors::waves(std::ptrdiff_t row, std::ptrdiff_t block) const {
    WaveBlock waves{.kx = {}, .k = {}, .ky = ky_rad_m(row), .first = block * lane_count, .nx = nx_};
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
        const double kx = kx_rad_m(waves.first + lane);
        waves.kx[lane] = kx;
        waves.k[lane] = std::sqrt(kx * kx + waves.ky * waves.ky);
    }
    return waves;
}

Counted WaveVectors::counted(std::ptrdiff_t row, std::ptrdiff_t block) const {
    Counted weight;
    const double both = share_.ky_start + row == 0 ? 1.0 : 2.0;
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
        const std::ptrdiff_t i = block * lane_count + lane;
        const double plus = is_there(i) ? both : 0.0, minus = i == 0 ? 0.0 : plus;
        weight.part[plus_re][lane] = weight.part[plus_im][lane] = plus;
        weight.part[minus_re][lane] = weight.part[minus_im][lane] = minus;
    }
    return weight;
}

void WaveVectors::clear_nyquist(double* plane) const {
    for (std::ptrdiff_t row = 0; row < rows(); ++row) {
        double* line = plane + 2 * row * nx_;
        line[nx_] = line[nx_ + 1] = 0.0;
        if (is_nyquist(row)) std::fill_n(line, 2 * nx_, 0.0);
    }
}

double WaveVectors::largest_k_rad_m() const {
    return std::hypot(kx_rad_m(nx_ / 2), two_pi / extent_y_m_ * static_cast<double>(ny_ / 2));
}

MovingLoad::MovingLoad(const Case& c, const WaveVectors& vectors, double step_s)
    : case_(c), kernels_(simd::kernels<PencilKernels>()), vectors_(vectors), step_s_(step_s),
      pattern_(c.scene().load, c.time.duration_s() + 2.0 * step_s) {
    if (!pattern_.changes()) put_shape(shape_);
}

/// The spectrum of the pattern in its current state.
void MovingLoad::put_shape(Shape& shape) const {
    const std::ptrdiff_t count = vectors_.blocks() * lane_count;
    shape.assign(static_cast<std::size_t>(parts * vectors_.pencils()), Block{});
    std::vector<double> kx;
    for (std::ptrdiff_t i = 0; i < count; ++i)
        kx.push_back(vectors_.kx_rad_m(i));
    for (std::ptrdiff_t i = 0; i < count; ++i)
        kx.push_back(-vectors_.kx_rad_m(i));
    std::vector<Complex> spectra(kx.size());
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        if (std::abs(vectors_.ky_rad_m(row)) > pattern_.band_rad_m()) continue;
        pattern_.spectra(vectors_.ky_rad_m(row), kx, spectra);
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            if (!vectors_.is_there(i)) continue;
            Block* at = shape.data() + parts * (row * vectors_.blocks() + i / lane_count);
            const std::ptrdiff_t lane = i % lane_count;
            const Complex plus = spectra[static_cast<std::size_t>(i)],
                          minus = spectra[static_cast<std::size_t>(count + i)];
            at[plus_re][lane] = plus.real();
            at[plus_im][lane] = plus.imag();
            at[minus_re][lane] = minus.real();
            at[minus_im][lane] = minus.imag();
        }
    }
}

/// Two of the three samples of a step are those of the previous step and are reused.
void MovingLoad::reuse(std::ptrdiff_t first_step) {
    for (std::size_t s = 0; s < loads_.size(); ++s)
        for (std::size_t from = s + 1; from < loads_.size(); ++from)
            if (loads_[from].step == first_step + static_cast<std::ptrdiff_t>(s))
                std::swap(loads_[s], loads_[from]);
}

void MovingLoad::place(Sampled& load, std::ptrdiff_t step) {
    load.step = step;
    pattern_.set(pattern_.held_s(static_cast<double>(step) * step_s_));
    if (pattern_.changes()) put_shape(load.shape);
    const Vec2 origin = pattern_.origin_m() - Vec2{case_.domain.x_m(0), case_.domain.y_m(0)};
    load.x.resize(static_cast<std::size_t>(vectors_.blocks() * lane_count));
    load.y.resize(static_cast<std::size_t>(vectors_.rows()));
    for (std::size_t i = 0; i < load.x.size(); ++i)
        load.x[i] = std::polar(1.0, -vectors_.kx_rad_m(static_cast<std::ptrdiff_t>(i)) * origin.x);
    for (std::size_t j = 0; j < load.y.size(); ++j)
        load.y[j] = std::polar(1.0, -vectors_.ky_rad_m(static_cast<std::ptrdiff_t>(j)) * origin.y);
}

namespace {

/// Weight of a sample of a load that is switched off. It is one half at the end, so that the sum of
/// the samples equals the integral of the load. If the end lies between two steps, the first moment
/// is preserved, too.
double share_before(double end_steps, std::ptrdiff_t step) {
    const double last = std::floor(end_steps + 1e-9);
    const double after = end_steps - last, at = static_cast<double>(step);
    const double next = 0.5 * after * after;
    if (at < last) return 1.0;
    if (at == last) return 0.5 + after - next;
    return at == last + 1.0 ? next : 0.0;
}

} // namespace

void MovingLoad::sample(std::ptrdiff_t n) {
    const double off_s = off_time_s(case_.scene().load.modulation.trajectory);
    const double area_m2 = case_.domain.extent_x_m() * case_.domain.extent_y_m();
    const auto samples = samples_at(n);
    reuse(samples.front().step);
    for (std::size_t s = 0; s < samples.size(); ++s) {
        const double t_s = static_cast<double>(samples[s].step) * step_s_;
        Sampled& load = loads_[s];
        if (load.step != samples[s].step) place(load, samples[s].step);
        load.amplitude_Pa = share_before(off_s / step_s_, samples[s].step) * samples[s].weight *
                            case_.scene().load.peak_Pa * amplitude(case_.scene().load, t_s) /
                            area_m2;
    }
}

void MovingLoad::put(std::ptrdiff_t row, std::ptrdiff_t block, Block* surface) const {
    const std::ptrdiff_t pencil = parts * (row * vectors_.blocks() + block);
    LoadSample samples[3];
    for (std::size_t i = 0; i < loads_.size(); ++i) {
        const Sampled& load = loads_[i];
        const Complex y = load.amplitude_Pa * load.y[static_cast<std::size_t>(row)];
        samples[i] = {.x = fft::reals(load.x.data() + block * lane_count),
                      .y_re = y.real(),
                      .y_im = y.imag(),
                      .shape = pattern_.changes() ? load.shape.data() + pencil : nullptr};
    }
    kernels_.put_load(samples, pattern_.changes() ? nullptr : shape_.data() + pencil, surface);
}

} // namespace shearwake::spectral
