// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/moving_load.hpp"

#include "base/units.hpp"
#include "fft/aligned.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

namespace shearwake::spectral {
namespace {

using Complex = std::complex<double>;

/// Breaks are searched for in ranges of this many steps, as far as the run has come: a probe of a
/// long run advances a part of it only, and a resumed run finds the same breaks.
constexpr std::ptrdiff_t searched_steps = 64;
/// A break this close to the end of a range belongs to both sides [steps].
constexpr double tolerance_steps = 1e-6;

/// Times (in steps) of the samples of a smooth load that contribute to step n, and their weights.
struct Sample {
    std::ptrdiff_t step;
    double weight;
};
std::array<Sample, 3> samples_at(std::ptrdiff_t n) {
    if (n == 0) return {{{0, 7.0 / 12.0}, {1, 0.5}, {2, -1.0 / 12.0}}};
    return {{{n - 1, 1.0 / 12.0}, {n, 10.0 / 12.0}, {n + 1, 1.0 / 12.0}}};
}

/// The weight of the load at a time, for step n.
double hat(double steps, std::ptrdiff_t n) {
    const double share = std::max(1.0 - std::abs(steps - static_cast<double>(n)), 0.0);
    return n == 0 ? 2.0 * share : share; // at the start there is only the half after it
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

MovingLoad::MovingLoad(const Case& c, const WaveVectors& vectors, double step_s,
                       LoadPattern pattern)
    : case_(c), kernels_(simd::kernels<PencilKernels>()), vectors_(vectors), step_s_(step_s),
      pattern_(std::move(pattern)) {
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

/// Finds the breaks up to two steps after n.
void MovingLoad::find_breaks(std::ptrdiff_t n) {
    const auto drop = [&](double at) { return at < static_cast<double>(n) - 2.0; };
    for (searched_ = std::max(searched_, std::max<std::ptrdiff_t>(n - 1, 0) / searched_steps);
         searched_ * searched_steps < n + 3; ++searched_) {
        std::erase_if(breaks_, drop);
        const double from_s = static_cast<double>(searched_ * searched_steps) * step_s_;
        for (const Break& each :
             breaks_of(case_.scene.load, from_s,
                       from_s + static_cast<double>(searched_steps) * step_s_, step_s_))
            // Nothing precedes the start.
            if (each.time_s > tolerance_steps * step_s_) breaks_.push_back(each.time_s / step_s_);
    }
}

void MovingLoad::choose_nodes(std::ptrdiff_t n) {
    find_breaks(n);
    const double first = std::max(static_cast<double>(n) - 1.0, 0.0),
                 last = static_cast<double>(n == 0 ? 2 : n + 1); // of samples_at()
    nodes_.clear();
    const auto is_near = [&](double at) {
        return at > first - tolerance_steps && at < last + tolerance_steps;
    };
    if (std::ranges::none_of(breaks_, is_near)) {
        for (const Sample& sample : samples_at(n))
            nodes_.push_back({static_cast<double>(sample.step), sample.weight});
        return;
    }
    const double end = static_cast<double>(n + 1);
    std::vector<double> ends = {first, static_cast<double>(n), end};
    std::ranges::copy_if(breaks_, std::back_inserter(ends),
                         [&](double at) { return at > first && at < end; });
    std::ranges::sort(ends);
    for (std::size_t i = 1; i < ends.size(); ++i) {
        const double middle = 0.5 * (ends[i - 1] + ends[i]), half = 0.5 * (ends[i] - ends[i - 1]);
        if (half < tolerance_steps) continue;
        for (const double at : {middle - half / std::sqrt(3.0), middle + half / std::sqrt(3.0)})
            nodes_.push_back({at, half * hat(at, n)});
    }
}

void MovingLoad::place(Sampled& load, double updated_s) {
    load.updated_s = updated_s;
    pattern_.set(updated_s);
    if (pattern_.changes()) put_shape(load.shape);
    const Vec2 origin = pattern_.origin_m() - Vec2{case_.domain.x_m(0), case_.domain.y_m(0)};
    load.x.resize(static_cast<std::size_t>(vectors_.blocks() * lane_count));
    load.y.resize(static_cast<std::size_t>(vectors_.rows()));
    for (std::size_t i = 0; i < load.x.size(); ++i)
        load.x[i] = std::polar(1.0, -vectors_.kx_rad_m(static_cast<std::ptrdiff_t>(i)) * origin.x);
    for (std::size_t j = 0; j < load.y.size(); ++j)
        load.y[j] = std::polar(1.0, -vectors_.ky_rad_m(static_cast<std::ptrdiff_t>(j)) * origin.y);
}

void MovingLoad::sample(std::ptrdiff_t n) {
    choose_nodes(n);
    const Load& given = case_.scene.load;
    const double area_m2 = case_.domain.extent_x_m() * case_.domain.extent_y_m();
    // Placing a load is expensive: those of the previous step are reused, and an array that updates
    // its focus rarely is placed once per update.
    std::swap(loads_, spare_);
    loads_.clear();
    for (const Node& node : nodes_) {
        const double t_s = node.steps * step_s_, updated_s = pattern_.updated_s(t_s);
        auto at = std::ranges::find(loads_, updated_s, &Sampled::updated_s);
        if (at == loads_.end()) {
            const auto former = std::ranges::find(spare_, updated_s, &Sampled::updated_s);
            if (former != spare_.end()) {
                loads_.push_back(std::move(*former));
                spare_.erase(former);
            } else {
                loads_.emplace_back();
                place(loads_.back(), updated_s);
            }
            at = std::prev(loads_.end());
            at->amplitude_Pa = 0.0;
        }
        at->amplitude_Pa += node.weight * given.peak_Pa * strength(given, t_s) / area_m2;
    }
    spare_.clear();
}

void MovingLoad::put(std::ptrdiff_t row, std::ptrdiff_t block, Block* surface) const {
    const std::ptrdiff_t pencil = parts * (row * vectors_.blocks() + block);
    std::vector<LoadSample> samples;
    samples.reserve(loads_.size());
    for (const Sampled& load : loads_) {
        const Complex y = load.amplitude_Pa * load.y[static_cast<std::size_t>(row)];
        samples.push_back({.x = fft::reals(load.x.data() + block * lane_count),
                           .y_re = y.real(),
                           .y_im = y.imag(),
                           .shape = pattern_.changes() ? load.shape.data() + pencil : nullptr});
    }
    kernels_.put_load(std::ssize(samples), samples.data(),
                      pattern_.changes() ? nullptr : shape_.data() + pencil, surface);
}

} // namespace shearwake::spectral
