// SPDX-License-Identifier: BSD-3-Clause
#include "measures/sensation.hpp"

#include "base/units.hpp"
#include "measures/kernels/row_sums.hpp"
#include "measures/window.hpp"
#include "problem/load/load.hpp"
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

/// The load without what does not change between two times: gains that rise or fall once, and paths
/// at whose end the focus rests already.
Load changing_load(Load load, double from_s, double to_s) {
    std::erase_if(load.modulation.envelope.gains,
                  [&](const Gain& gain) { return rests(gain, from_s, to_s); });
    for (Mover& mover : load.modulation.trajectory.parts)
        if (const auto* travel = std::get_if<Travel>(&mover);
            travel && travel->at_end == AtEnd::hold && cycle_s(*travel) <= from_s)
            mover = Hold{};
    return load;
}

/// Why there is no whole period of a load between two times that are `settled_s` apart, with the
/// time that the slowest part of the load needs.
std::string period_reason(const Load& load, const LoadPeriod& period, double settled_s) {
    if (!aperiodicity_reason(load).empty())
        return "the load does not repeat between measure.settled_after_ms and measure.at_ms: " +
               std::string(std::ranges::any_of(load.modulation.envelope.gains, acts_once)
                               ? "it rises or falls once; choose times after that"
                               : "its path ends; set path.at_end = \"repeat\" or "
                                 "\"back-and-forth\"");
    const std::vector<double> frequencies_Hz = frequencies_of(load);
    if (frequencies_Hz.empty())
        return "the load does not change between measure.settled_after_ms and measure.at_ms";
    if (frequencies_Hz.size() > 1)
        return "the load " + period.reason.substr(0, period.reason.find(';')) +
               "; use commensurate frequencies, or a longer run";
    const bool is_gain = std::ranges::any_of(load.modulation.envelope.gains, [&](const Gain& g) {
        return repetition_Hz(g) == frequencies_Hz.front();
    });
    return fmt::format("{} at {:.4g} Hz needs {:.4g} ms between measure.settled_after_ms and "
                       "measure.at_ms, which are {:.4g} ms apart",
                       is_gain ? "AM" : "the motion of the focus", frequencies_Hz.front(),
                       1e-3 * std::ceil(1e6 / frequencies_Hz.front() * (1.0 - rounding)),
                       1e3 * settled_s);
}

/// Sets the window and the period of the load [s], or the reason why there is none.
double set_window(const Case& c, SensationLines& lines) {
    const TimeAxis& time = c.time;
    const double settled_after_s = c.measure.settled_after_s,
                 // The second difference at the last frame would need the one after it.
        to_s = std::min(c.measure.at_s, time.duration_s() - time.interval_s),
                 settled_s = to_s - settled_after_s + time.interval_s;
    lines.reason = no_focus_reason(c.measure, time, off_time_s(c.scene.load.modulation.trajectory));
    if (!(settled_s > 4.0 * time.interval_s) && lines.reason.empty())
        lines.reason = "fewer than four frames lie between measure.settled_after_ms and "
                       "measure.at_ms";
    if (!lines.reason.empty()) return 0.0;
    for (const Gain& gain : c.scene.load.modulation.envelope.gains)
        if (rests(gain, settled_after_s, to_s) &&
            !(shearwake::gain({{gain}}, 0.5 * (settled_after_s + to_s)) > 0.0))
            lines.reason = "the load is off between measure.settled_after_ms and measure.at_ms";
    if (!lines.reason.empty()) return 0.0;
    const Load load = changing_load(c.scene.load, settled_after_s, to_s);
    const LoadPeriod period = least_period(load, settled_s);
    if (!period.reason.empty()) {
        lines.reason = period_reason(load, period, c.measure.at_s - settled_after_s);
        return 0.0;
    }
    lines.window_s = std::floor(settled_s / period.period_s * (1.0 + rounding)) * period.period_s;
    lines.weights = window_weights(time, std::max(0.0, to_s - lines.window_s), to_s);
    const double sum = std::reduce(lines.weights.begin(), lines.weights.end());
    for (double& weight : lines.weights)
        weight /= sum;
    return period.period_s;
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
    lines.bands = sensation_bands(c.sensation ? c.sensation->threshold : std::vector<Vec2>{});
    const double nyquist_Hz = 0.5 / lines.interval_s;
    if (lines.bands.back().high_Hz > nyquist_Hz) {
        lines.reason = fmt::format("frames every {:g} us cannot represent {:g} Hz",
                                   1e6 * lines.interval_s, lines.bands.back().high_Hz);
        return lines;
    }
    double period_s = c.time.duration_s();
    if (lines.repeats) {
        lines.window_s = period_s;
        lines.weights.assign(static_cast<std::size_t>(c.time.frames),
                             1.0 / static_cast<double>(c.time.frames));
    } else {
        period_s = set_window(c, lines);
        if (!lines.reason.empty()) return lines;
    }
    const double low_Hz = lines.bands.front().low_Hz, high_Hz = lines.bands.back().high_Hz;
    for (double n = std::max(1.0, std::ceil(low_Hz * period_s * (1.0 - rounding)));
         n <= high_Hz * period_s * (1.0 + rounding) && n < nyquist_Hz * period_s * (1.0 - rounding);
         ++n)
        lines.frequencies_Hz.push_back(n / period_s);
    if (lines.frequencies_Hz.empty())
        lines.reason = fmt::format("the load has no line between {:g} and {:g} Hz",
                                   lines.bands.front().low_Hz, lines.bands.back().high_Hz);
    return lines;
}

double SensationLines::threshold_m_s2(double f_Hz) const {
    const auto above = std::ranges::upper_bound(bands, f_Hz, {}, &SensationBand::centre_Hz);
    if (above == bands.begin()) return bands.front().threshold_m_s2;
    if (above == bands.end()) return bands.back().threshold_m_s2;
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
    all.reserve(frequencies_Hz.size());
    for (const double f_Hz : frequencies_Hz) {
        const double turn = two_pi * f_Hz * interval_s;
        const double response = 2.0 - 2.0 * std::cos(turn);
        const auto at = [&](std::ptrdiff_t n) {
            if (!repeats && (n < 0 || n >= frames)) return std::complex<double>{};
            return std::polar(1.0, -turn * static_cast<double>(n + 1)) *
                   weights[static_cast<std::size_t>((n + frames) % frames)];
        };
        all.push_back(std::pow(two_pi * f_Hz, 2) / response *
                      (2.0 * at(number) - at(number - 1) - at(number + 1)));
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
    factors_.assign(lines_.frequencies_Hz.size() * 2 * line_frames, 0.0);
    sums_.resize(static_cast<std::size_t>(count_ * row_length() / lane_count));
}

std::ptrdiff_t SensationSums::row_length() const {
    return 2 * filled_ * static_cast<std::ptrdiff_t>(lines_.frequencies_Hz.size());
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
        kernels.add_lines(scalars(frames_.data()) +
                              i * static_cast<std::ptrdiff_t>(line_frames) * filled_,
                          waiting_, filled_, factors_.data(),
                          2 * static_cast<std::ptrdiff_t>(lines_.frequencies_Hz.size()),
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
        for (const double line_Hz : lines_.frequencies_Hz) {
            const std::size_t band = lines_.band_of(line_Hz);
            const double scale = 2.0 / std::pow(lines_.threshold_m_s2(line_Hz), 2); // 2 |A|^2: rms
            for (std::ptrdiff_t j = 0; j < columns_ && band < lines_.bands.size(); ++j)
                ratios[band * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(j)] +=
                    scale * std::norm(std::complex<double>(part[j], part[filled_ + j]));
            part += 2 * filled_;
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
        2.0 * static_cast<double>(lines.frequencies_Hz.size()) + static_cast<double>(line_frames);
    constexpr double maps = 6.0; // three of the rank and three on rank 0
    return std::min(rows, std::ceil(rows / ranks) + 1.0) * (columns + lane_count) * of_slab *
               sizeof(double) +
           maps * rows * columns * sizeof(double);
}

} // namespace shearwake::measures
