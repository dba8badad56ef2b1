// SPDX-License-Identifier: BSD-3-Clause
#include "measures/sensation.hpp"

#include "base/units.hpp"
#include "measures/kernels/row_sums.hpp"
#include "measures/window.hpp"
#include "problem/case/sensation_window.hpp"
#include "problem/load/footprint.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace shearwake::measures {
namespace {

constexpr double rounding = 1e-9; // relative, for rounding

/// Squares of the threshold, -180 dB, up to which nothing moves: a motion of a millimetre outside
/// of all bands has -206 dB in one, by rounding.
constexpr double no_motion = 1e-18;

// The built-in threshold: centres [Hz] and rms accelerations [m/s^2].
constexpr std::array centres_Hz = {8.0,  10.0, 12.5,  16.0,  20.0,  25.0,  31.5,  40.0, 50.0,
                                   63.0, 80.0, 100.0, 125.0, 160.0, 200.0, 250.0, 315.0};
constexpr std::array hand_m_s2 = {0.095, 0.1,   0.095, 0.108, 0.15,  0.16,  0.109, 0.065, 0.072,
                                  0.049, 0.028, 0.023, 0.022, 0.021, 0.029, 0.032, 0.061};
static_assert(centres_Hz.size() == hand_m_s2.size());

/// Lines per 1/T of a Hann window.
constexpr double hann_lines = 2.0;
/// Half the width of the spectrum of a tone in a Hann window [1/T].
constexpr double hann_reach = 2.0;

/// Sets the window, or the reason why there is none. A Hann window judges fewer bands.
void set_window(const Case& c, SensationLines& lines) {
    const TimeAxis& time = c.time;
    const SensationWindow window = sensation_window(c);
    lines.reason =
        no_focus_reason(c.measure, time, off_time_s(c.scene().load.modulation.trajectory));
    if (lines.reason.empty()) lines.reason = window.reason;
    if (!lines.reason.empty()) return;
    lines.window_s = window.duration_s;
    const double from_s = std::max(0.0, window.end_s - lines.window_s);
    if (window.has_whole_periods) {
        lines.weights = window_weights(time, from_s, window.end_s);
    } else {
        lines.weights.assign(static_cast<std::size_t>(time.frames), 0.0);
        lines.slopes = lines.weights;
        // By Parseval's theorem, lines 1/T apart have 3/2 of the power of a tone.
        lines.power = 1.0 / (1.5 * hann_lines);
        const double turn = std::numbers::pi / lines.window_s;
        for (std::ptrdiff_t n = 0; n < time.frames; ++n) {
            const double t_s = time.frame_s(n);
            if (!(t_s > from_s && t_s < window.end_s)) continue;
            const auto at = static_cast<std::size_t>(n);
            lines.weights[at] = std::pow(std::sin(turn * (t_s - from_s)), 2);
            lines.slopes[at] = turn * std::sin(2.0 * turn * (t_s - from_s));
        }
        std::erase_if(lines.bands, [&](const SensationBand& band) {
            return band.centre_Hz * lines.window_s < fewest_periods_in_window * (1.0 - rounding);
        });
        if (lines.bands.empty())
            lines.reason = fmt::format("the window of {:.3g} ms is shorter than three periods of "
                                       "the highest band",
                                       1e3 * lines.window_s);
    }
    const double sum = std::reduce(lines.weights.begin(), lines.weights.end());
    for (std::vector<double>* values : {&lines.weights, &lines.slopes})
        for (double& value : *values)
            value /= sum;
}

} // namespace

std::vector<SensationBand> sensation_bands(std::span<const Vec2> table) {
    std::vector<SensationBand> bands;
    const auto add = [&](double centre_Hz, double threshold_m_s2, bool is_extrapolated) {
        const double n = std::round(10.0 * std::log10(centre_Hz));
        bands.push_back({centre_Hz, std::pow(10.0, 0.1 * (n - 0.5)),
                         std::pow(10.0, 0.1 * (n + 0.5)), threshold_m_s2, is_extrapolated});
    };
    for (const Vec2 row : table)
        add(row.x, row.y, false);
    if (!table.empty()) return bands;
    for (std::size_t n = 0; n < centres_Hz.size(); ++n)
        add(centres_Hz[n], hand_m_s2[n], false);
    // The slope between 160 and 315 Hz, three third octaves, over log f.
    const double third = std::cbrt(hand_m_s2.back() / hand_m_s2[13]);
    add(400.0, hand_m_s2.back() * third, true);
    add(500.0, hand_m_s2.back() * third * third, true);
    bands.front().low_Hz = bands.front().centre_Hz;
    bands.back().high_Hz = bands.back().centre_Hz;
    return bands;
}

SensationLines sensation_lines(const Case& c) {
    SensationLines lines;
    lines.interval_s = c.time.interval_s;
    lines.repeats = c.time.regime == Regime::periodic;
    if (std::ranges::find(c.measure.depths_m, 0.0) == c.measure.depths_m.end()) {
        lines.reason = "measure.depths_mm does not contain 0, the surface";
        return lines;
    }
    lines.threshold = sensation_bands(c.sensation ? c.sensation->threshold : std::vector<Vec2>{});
    lines.bands = lines.threshold;
    const double nyquist_Hz = 0.5 / lines.interval_s;
    if (lines.bands.back().high_Hz > nyquist_Hz) {
        lines.reason = fmt::format("frames every {:g} us cannot represent {:g} Hz",
                                   1e6 * lines.interval_s, lines.bands.back().high_Hz);
        return lines;
    }
    if (lines.repeats) {
        lines.window_s = c.time.duration_s();
        lines.weights.assign(static_cast<std::size_t>(c.time.frames),
                             1.0 / static_cast<double>(c.time.frames));
    } else {
        set_window(c, lines);
        if (!lines.reason.empty()) return lines;
    }
    const bool is_hann = !lines.slopes.empty();
    const double step_Hz = 1.0 / ((is_hann ? hann_lines : 1.0) * lines.window_s),
                 reach_Hz = is_hann ? hann_reach / lines.window_s : 0.0;
    const double low_Hz = lines.bands.front().low_Hz - reach_Hz,
                 high_Hz = lines.bands.back().high_Hz + reach_Hz;
    for (double n = std::max(1.0, std::ceil(low_Hz / step_Hz * (1.0 - rounding)));
         n * step_Hz <= high_Hz * (1.0 + rounding) && n * step_Hz < nyquist_Hz * (1.0 - rounding);
         ++n)
        lines.frequencies_Hz.push_back(n * step_Hz);
    if (lines.frequencies_Hz.empty())
        lines.reason = fmt::format("the load has no line between {:g} and {:g} Hz",
                                   lines.bands.front().low_Hz, lines.bands.back().high_Hz);
    return lines;
}

double SensationLines::threshold_m_s2(double f_Hz) const {
    const auto above = std::ranges::upper_bound(threshold, f_Hz, {}, &SensationBand::centre_Hz);
    if (above == threshold.begin()) return threshold.front().threshold_m_s2;
    if (above == threshold.end()) return threshold.back().threshold_m_s2;
    const SensationBand& below = *std::prev(above);
    return below.threshold_m_s2 * std::pow(above->threshold_m_s2 / below.threshold_m_s2,
                                           std::log(f_Hz / below.centre_Hz) /
                                               std::log(above->centre_Hz / below.centre_Hz));
}

std::size_t SensationLines::band_of(double f_Hz) const {
    if (f_Hz < bands.front().low_Hz * (1.0 - rounding)) return bands.size();
    return static_cast<std::size_t>(
        std::ranges::find_if(
            bands, [&](double high_Hz) { return f_Hz <= high_Hz * (1.0 + rounding); },
            &SensationBand::high_Hz) -
        bands.begin());
}

std::vector<std::complex<double>> SensationLines::factors(std::ptrdiff_t number) const {
    const auto frames = static_cast<std::ptrdiff_t>(weights.size());
    std::vector<std::complex<double>> all;
    all.reserve(sums());
    for (const double f_Hz : frequencies_Hz) {
        const double turn = two_pi * f_Hz * interval_s;
        const double response = 2.0 - 2.0 * std::cos(turn);
        const auto add = [&](const std::vector<double>& window) {
            const auto at = [&](std::ptrdiff_t n) {
                if (!repeats && (n < 0 || n >= frames)) return std::complex<double>{};
                return std::polar(1.0, -turn * static_cast<double>(n + 1)) *
                       window[static_cast<std::size_t>((n + frames) % frames)];
            };
            all.push_back(std::pow(two_pi * f_Hz, 2) / response *
                          (2.0 * at(number) - at(number - 1) - at(number + 1)));
        };
        add(weights);
        if (!slopes.empty()) add(slopes);
    }
    return all;
}

SensationSums::SensationSums(const Case& c, std::ptrdiff_t x_start, std::ptrdiff_t x_count)
    : region_(measured_region(c.domain, c.measure)), x_start_(x_start) {
    if (!computes_sensation(c)) return;
    lines_ = sensation_lines(c);
    if (!lines_.reason.empty()) return;
    first_ = std::clamp(x_start, region_.x0, std::max(region_.x0, region_.x1)) - region_.x0;
    count_ = std::clamp(x_start + x_count, region_.x0, std::max(region_.x0, region_.x1)) -
             region_.x0 - first_;
    columns_ = std::max<std::ptrdiff_t>(0, region_.y1 - region_.y0);
    filled_ = (columns_ + lane_count - 1) / lane_count * lane_count;
    frames_.resize(static_cast<std::size_t>(count_ * filled_ / lane_count) * line_frames);
    factors_.assign(lines_.sums() * 2 * line_frames, 0.0);
    sums_.resize(static_cast<std::size_t>(count_ * row_length() / lane_count));
}

std::ptrdiff_t SensationSums::row_length() const {
    return 2 * filled_ * static_cast<std::ptrdiff_t>(lines_.sums());
}

void SensationSums::add(std::ptrdiff_t number, View2<const double> u_z_m) {
    if (sums_.empty()) return;
    const auto factors = lines_.factors(number);
    if (std::ranges::all_of(factors, [](const auto& f) { return f == 0.0; })) return;
    for (std::size_t k = 0; k < factors.size(); ++k) {
        factors_[(2 * k) * line_frames + static_cast<std::size_t>(waiting_)] = factors[k].real();
        factors_[(2 * k + 1) * line_frames + static_cast<std::size_t>(waiting_)] =
            factors[k].imag();
    }
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
        const auto row = u_z_m.row(region_.x0 + first_ + i - x_start_);
        std::copy_n(row.begin() + region_.y0, columns_,
                    scalars(frames_.data()) +
                        (i * static_cast<std::ptrdiff_t>(line_frames) + waiting_) * filled_);
    }
    if (++waiting_ == static_cast<std::ptrdiff_t>(line_frames)) flush();
}

void SensationSums::flush() {
    if (waiting_ == 0) return;
    // Frames that are missing have factors of zero.
    for (std::size_t k = 0; k < factors_.size(); k += line_frames)
        std::fill(factors_.begin() + static_cast<std::ptrdiff_t>(k) + waiting_,
                  factors_.begin() + static_cast<std::ptrdiff_t>(k + line_frames), 0.0);
    const RowSumKernels& kernels = simd::kernels<RowSumKernels>();
    for (std::ptrdiff_t i = 0; i < count_; ++i)
        kernels.add_lines(
            scalars(frames_.data()) + i * static_cast<std::ptrdiff_t>(line_frames) * filled_,
            waiting_, filled_, factors_.data(), 2 * static_cast<std::ptrdiff_t>(lines_.sums()),
            sums() + i * row_length());
    waiting_ = 0;
}

SensationMap SensationSums::levels() {
    flush();
    SensationMap map{.x0 = region_.x0, .y0 = region_.y0, .rows = count_, .columns = columns_};
    if (sums_.empty()) {
        map.rows = map.columns = 0;
        return map;
    }
    std::vector<double> ratios(lines_.bands.size() * static_cast<std::size_t>(columns_));
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
        std::ranges::fill(ratios, 0.0);
        const double* part = sums() + i * row_length();
        const auto at = [&](std::ptrdiff_t sum, std::ptrdiff_t j) {
            return std::complex<double>(part[2 * sum * filled_ + j],
                                        part[(2 * sum + 1) * filled_ + j]);
        };
        const auto add_line = [&](double f_Hz, std::ptrdiff_t j, double square) {
            const std::size_t band = lines_.band_of(f_Hz);
            if (band < lines_.bands.size()) // rms: 2 |A_k|^2 per line
                ratios[band * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(j)] +=
                    2.0 * lines_.power * square / std::pow(lines_.threshold_m_s2(f_Hz), 2);
        };
        for (const double line_Hz : lines_.frequencies_Hz) {
            for (std::ptrdiff_t j = 0; j < columns_; ++j) {
                const std::complex<double> amplitude = at(0, j);
                const double offset_Hz =
                    lines_.slopes.empty() ? 0.0 : (at(1, j) / amplitude).imag() / two_pi;
                add_line(line_Hz - offset_Hz, j, std::norm(amplitude));
            }
            part += row_length() / std::ssize(lines_.frequencies_Hz);
        }
        for (std::size_t j = 0; j < static_cast<std::size_t>(columns_); ++j) {
            double most = no_motion, sum = 0.0, band_Hz = not_a_number;
            for (std::size_t b = 0; b < lines_.bands.size(); ++b) {
                const double ratio = ratios[b * static_cast<std::size_t>(columns_) + j];
                sum += ratio;
                if (!(ratio > most)) continue;
                most = ratio;
                band_Hz = lines_.bands[b].centre_Hz;
            }
            const bool moves = most > no_motion;
            map.level_dB.push_back(moves ? 10.0 * std::log10(most) : not_a_number);
            map.sum_dB.push_back(moves ? 10.0 * std::log10(sum) : not_a_number);
            map.band_Hz.push_back(band_Hz);
        }
    }
    return map;
}

double sensation_memory_B(const Case& c, int ranks) {
    if (!computes_sensation(c)) return 0.0;
    const SensationLines lines = sensation_lines(c);
    if (!lines.reason.empty()) return 0.0;
    const Region region = measured_region(c.domain, c.measure);
    const auto rows = static_cast<double>(region.x1 - region.x0),
               columns = static_cast<double>(region.y1 - region.y0);
    const double of_slab =
        2.0 * static_cast<double>(lines.sums()) + static_cast<double>(line_frames);
    constexpr double maps = 6.0; // three of the rank and three on rank 0
    return std::min(rows, std::ceil(rows / ranks) + 1.0) * (columns + lane_count) * of_slab *
               sizeof(double) +
           maps * rows * columns * sizeof(double);
}

} // namespace shearwake::measures
