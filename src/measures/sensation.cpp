// SPDX-License-Identifier: BSD-3-Clause
#include "measures/sensation.hpp"

#include "base/units.hpp"
#include "measures/kernels/row_sums.hpp"
#include "measures/spatial_measures.hpp"
#include "measures/summary.hpp"
#include "measures/window.hpp"
#include "problem/load/footprint.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

namespace shearwake::measures {
namespace {

constexpr double rounding = 1e-9; // relative, for rounding

constexpr std::array<Vec2, 17> hand = {{{8.0, 0.095},
                                        {10.0, 0.1},
                                        {12.5, 0.095},
                                        {16.0, 0.108},
                                        {20.0, 0.15},
                                        {25.0, 0.16},
                                        {31.5, 0.109},
                                        {40.0, 0.065},
                                        {50.0, 0.072},
                                        {63.0, 0.049},
                                        {80.0, 0.028},
                                        {100.0, 0.023},
                                        {125.0, 0.022},
                                        {160.0, 0.021},
                                        {200.0, 0.029},
                                        {250.0, 0.032},
                                        {315.0, 0.061}}};
constexpr std::array<double, 2> continued_Hz = {400.0, 500.0};

double number_of(double centre_Hz) {
    return std::round(10.0 * std::log10(centre_Hz));
}

/// Thresholds are straight lines over log f.
double continued(double centre_Hz) {
    const Vec2 from = hand[13], to = hand[16];
    const double slope =
        std::log(to.y / from.y) / (number_of(to.x) - number_of(from.x)); // a third octave
    return to.y * std::exp(slope * (number_of(centre_Hz) - number_of(to.x)));
}

/// Periods of its centre that a window must contain to judge a band.
constexpr double fewest_periods = 3.0;
/// Lines per 1/T of a Hann window. A line per 1/T would miss the bands below 4.3/T.
constexpr double hann_lines = 4.0;

/// The weights of a window of whole periods or of a Hann window, and its duration.
struct Window {
    std::vector<double> weights;
    double duration_s = 0.0, lines = 1.0;
    double power = 1.0;
    std::string reason;
};

Window window_of(const Case& c) {
    const TimeAxis& time = c.time;
    // The second difference at the last frame would need the one after it.
    const double to_s = std::min(c.measure.at_s, time.duration_s() - time.interval_s);
    const double settled_s = to_s - c.measure.settled_after_s + time.interval_s;
    Window window;
    window.reason =
        no_focus_reason(c.measure, time, off_time_s(c.scene().load.modulation.trajectory));
    if (!(settled_s > 4.0 * time.interval_s) && window.reason.empty())
        window.reason = "fewer than four frames lie between measure.settled_after_ms and "
                        "measure.at_ms";
    if (!window.reason.empty()) return window;
    const LoadPeriod period = least_period(c.scene().load, settled_s);
    const double periods =
        period.reason.empty() ? std::floor(settled_s / period.period_s * (1.0 + rounding)) : 0.0;
    if (periods >= 1.0) {
        window.duration_s = periods * period.period_s;
        window.weights = window_weights(time, std::max(0.0, to_s - window.duration_s), to_s);
    } else {
        window.duration_s = std::min(settled_s, to_s);
        window.lines = hann_lines;
        window.weights.assign(static_cast<std::size_t>(time.frames), 0.0);
        const double from_s = to_s - window.duration_s;
        for (std::ptrdiff_t n = 0; n < time.frames; ++n)
            if (const double t_s = time.frame_s(n); t_s > from_s && t_s < to_s)
                window.weights[static_cast<std::size_t>(n)] =
                    std::pow(std::sin(std::numbers::pi * (t_s - from_s) / window.duration_s), 2);
    }
    return window;
}

/// Divides by the sum; the power that the weights of equal mean let pass.
double normalised(std::vector<double>& weights, bool is_tapered) {
    const double sum = std::reduce(weights.begin(), weights.end());
    double squares = 0.0;
    for (double& weight : weights) {
        weight /= sum;
        squares += weight * weight;
    }
    // By Parseval's theorem, sums over lines 1/T apart have the power N sum w^2 / (sum w)^2, where
    // N is the number of frames of the window: 3/2 for a Hann window.
    return is_tapered ? squares : 1.0;
}

} // namespace

std::vector<SensationBand> sensation_bands(std::span<const Vec2> table) {
    std::vector<SensationBand> bands;
    const auto add = [&](double centre_Hz, double threshold_m_s2, bool is_extrapolated) {
        const double n = number_of(centre_Hz);
        bands.push_back({centre_Hz, std::pow(10.0, 0.1 * (n - 0.5)),
                         std::pow(10.0, 0.1 * (n + 0.5)), threshold_m_s2, is_extrapolated});
    };
    for (const Vec2 row : table.empty() ? std::span<const Vec2>(hand) : table)
        add(row.x, row.y, false);
    if (table.empty())
        for (const double centre_Hz : continued_Hz)
            add(centre_Hz, continued(centre_Hz), true);
    if (!table.empty()) return bands;
    bands.front().low_Hz = bands.front().centre_Hz;
    bands.back().high_Hz = bands.back().centre_Hz;
    return bands;
}

SensationLines sensation_lines(const Case& c) {
    SensationLines lines;
    lines.interval_s = c.time.interval_s;
    lines.repeats = c.time.regime == Regime::periodic;
    lines.is_window = !lines.repeats;
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
    double dense = 1.0;
    if (lines.repeats) {
        lines.window_s = c.time.duration_s();
        lines.weights.assign(static_cast<std::size_t>(c.time.frames),
                             1.0 / static_cast<double>(c.time.frames));
    } else {
        Window window = window_of(c);
        lines.reason = window.reason;
        if (!lines.reason.empty()) return lines;
        lines.window_s = window.duration_s;
        dense = window.lines;
        lines.weights = std::move(window.weights);
        const double squares = normalised(lines.weights, dense > 1.0);
        if (dense > 1.0) lines.power = lines.interval_s / (squares * lines.window_s * dense);
        std::erase_if(lines.bands, [&](const SensationBand& band) {
            return band.centre_Hz * lines.window_s < fewest_periods * (1.0 - rounding);
        });
        if (lines.bands.empty()) {
            lines.reason = fmt::format("the window of {:.3g} ms is shorter than three periods of "
                                       "the highest band",
                                       1e3 * lines.window_s);
            return lines;
        }
    }
    const double step_Hz = 1.0 / (dense * lines.window_s);
    const auto first =
        std::max(1.0, std::ceil(lines.bands.front().low_Hz / step_Hz * (1.0 - rounding)));
    std::size_t band = 0;
    for (double n = first; n * step_Hz <= lines.bands.back().high_Hz * (1.0 + rounding) &&
                           n * step_Hz < nyquist_Hz * (1.0 - rounding);
         ++n) {
        const double f_Hz = n * step_Hz;
        while (band + 1 < lines.bands.size() && f_Hz > lines.bands[band].high_Hz)
            ++band;
        lines.frequencies_Hz.push_back(f_Hz);
        lines.band_of.push_back(band);
    }
    if (lines.frequencies_Hz.empty())
        lines.reason = fmt::format("the load has no line between {:g} and {:g} Hz",
                                   lines.bands.front().low_Hz, lines.bands.back().high_Hz);
    return lines;
}

std::vector<std::complex<double>> SensationLines::factors(std::ptrdiff_t number) const {
    const auto frames = static_cast<std::ptrdiff_t>(weights.size());
    std::vector<std::complex<double>> all;
    all.reserve(frequencies_Hz.size());
    for (const double f_Hz : frequencies_Hz) {
        const double turn = two_pi * f_Hz * interval_s;
        const auto at = [&](std::ptrdiff_t n) {
            if (!repeats && (n < 0 || n >= frames)) return std::complex<double>{};
            const double weight = weights[static_cast<std::size_t>((n + frames) % frames)];
            return std::polar(weight, -turn * static_cast<double>(n + 1));
        };
        const double response = 2.0 - 2.0 * std::cos(turn);
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
    frames_.assign(static_cast<std::size_t>(count_ * columns_ * line_frames), 0.0);
    factors_.assign(lines_.frequencies_Hz.size() * 2 * line_frames, 0.0);
    sums_.assign(static_cast<std::size_t>(count_ * row_length()), 0.0);
}

std::ptrdiff_t SensationSums::row_length() const {
    return 2 * columns_ * static_cast<std::ptrdiff_t>(lines_.frequencies_Hz.size());
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
                    frames_.begin() +
                        (i * static_cast<std::ptrdiff_t>(line_frames) + waiting_) * columns_);
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
        kernels.add_lines(frames_.data() + i * static_cast<std::ptrdiff_t>(line_frames) * columns_,
                          columns_, factors_.data(),
                          2 * static_cast<std::ptrdiff_t>(lines_.frequencies_Hz.size()),
                          sums_.data() + i * row_length());
    waiting_ = 0;
}

SensationMap SensationSums::levels() {
    flush();
    SensationMap map{.x0 = region_.x0, .y0 = region_.y0, .rows = count_, .columns = columns_};
    if (sums_.empty()) {
        map.rows = map.columns = 0;
        return map;
    }
    std::vector<double> squares(lines_.bands.size() * static_cast<std::size_t>(columns_));
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
        std::ranges::fill(squares, 0.0);
        const double* part = sums_.data() + i * row_length();
        for (const std::size_t band : lines_.band_of)
            for (int side = 0; side < 2; ++side) {
                double* square = squares.data() + band * static_cast<std::size_t>(columns_);
                for (std::ptrdiff_t j = 0; j < columns_; ++j, ++part)
                    square[j] += 2.0 * lines_.power * *part * *part; // rms: 2 |A_k|^2 per line
            }
        for (std::size_t j = 0; j < static_cast<std::size_t>(columns_); ++j) {
            double most = 0.0, sum = 0.0, band_Hz = not_a_number;
            for (std::size_t b = 0; b < lines_.bands.size(); ++b) {
                const double ratio = squares[b * static_cast<std::size_t>(columns_) + j] /
                                     std::pow(lines_.bands[b].threshold_m_s2, 2);
                sum += ratio;
                if (!(ratio > most)) continue;
                most = ratio;
                band_Hz = lines_.bands[b].centre_Hz;
            }
            map.level_dB.push_back(most > 0.0 ? 10.0 * std::log10(most) : not_a_number);
            map.sum_dB.push_back(sum > 0.0 ? 10.0 * std::log10(sum) : not_a_number);
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
    return std::min(rows, std::ceil(rows / ranks) + 1.0) * columns * of_slab * sizeof(double) +
           maps * rows * columns * sizeof(double);
}

namespace {

/// Levels between the samples, and what is known of the path.
class Levels {
public:
    Levels(const Case& c, const SensationMap& map) : domain_(c.domain), map_(map) {}

    /// Bilinear; NaN outside the rectangle or where nothing moves.
    double at(Vec2 place_m, const std::vector<double>& values) const {
        const double x = place_m.x / domain_.spacing_m +
                         static_cast<double>(domain_.nx / 2 - map_.x0),
                     y = place_m.y / domain_.spacing_m +
                         static_cast<double>(domain_.ny / 2 - map_.y0);
        constexpr double edge = 1e-9;
        if (!(x >= -edge && y >= -edge && x <= static_cast<double>(map_.rows - 1) + edge &&
              y <= static_cast<double>(map_.columns - 1) + edge))
            return not_a_number;
        const auto index = [](double v, std::ptrdiff_t count) {
            return std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(std::floor(v)), 0,
                                              std::max<std::ptrdiff_t>(count - 2, 0));
        };
        const std::ptrdiff_t i = index(x, map_.rows), j = index(y, map_.columns);
        const double u = std::clamp(x - static_cast<double>(i), 0.0, 1.0),
                     v = std::clamp(y - static_cast<double>(j), 0.0, 1.0);
        double sum = 0.0;
        for (const auto& [di, wx] : {std::pair{0, 1.0 - u}, std::pair{1, u}})
            for (const auto& [dj, wy] : {std::pair{0, 1.0 - v}, std::pair{1, v}})
                if (wx * wy > 0.0)
                    sum += wx * wy *
                           values[static_cast<std::size_t>((i + di) * map_.columns + j + dj)];
        return sum;
    }
    double level(Vec2 place_m) const { return at(place_m, map_.level_dB); }

private:
    const Domain& domain_;
    const SensationMap& map_;
};

/// A point of the path with its share of the length and the direction across.
struct PathPoint {
    Vec2 at_m;
    double weight = 0.0;
    std::vector<Vec2> across; // unit vectors
};

std::vector<PathPoint> path_points(const std::vector<std::vector<Vec2>>& lines) {
    constexpr int directions = 36; // across a point that rests: all
    std::vector<PathPoint> points;
    for (const std::vector<Vec2>& line : lines) {
        if (line.size() == 1) {
            PathPoint point{line.front(), 1.0, {}};
            for (int d = 0; d < directions; ++d)
                point.across.push_back({std::cos(std::numbers::pi * d / directions),
                                        std::sin(std::numbers::pi * d / directions)});
            points.push_back(std::move(point));
        }
        for (std::size_t n = 0; n + 1 < line.size(); ++n) { // the middle of each segment
            const Vec2 along = line[n + 1] - line[n];
            const double length = norm(along);
            if (length > 0.0)
                points.push_back({0.5 * (line[n] + line[n + 1]),
                                  length,
                                  {{-along.y / length, along.x / length}}});
        }
    }
    return points;
}

/// The width of the profile through a point around its largest value within `near_m`, `drop_dB`
/// below that value; NaN if it does not fall that far inside the map.
double width_m(const Levels& levels, Vec2 at_m, Vec2 across, double near_m, double step_m,
               double drop_dB) {
    double top = levels.level(at_m), top_at = 0.0;
    for (double s = -near_m; s <= near_m; s += step_m)
        if (const double level = levels.level(at_m + s * across); level > top) {
            top = level;
            top_at = s;
        }
    double width = 0.0;
    for (const double side : {-1.0, 1.0}) {
        double before = top;
        for (double s = step_m;; s += step_m) {
            const double level = levels.level(at_m + (top_at + side * s) * across);
            if (std::isnan(level)) return not_a_number;
            if (level < top - drop_dB) {
                width += s - step_m * (top - drop_dB - level) / (before - level);
                break;
            }
            before = level;
        }
    }
    return width;
}

/// The depths of the saddles between the maxima inside a line and higher ones, descending. That of
/// the highest maximum is the height above the lowest value.
std::vector<double> prominences(const std::vector<double>& line) {
    std::vector<double> depths;
    for (std::size_t n = 1; n + 1 < line.size(); ++n) {
        std::size_t end = n; // of a plateau
        while (end + 1 < line.size() && line[end + 1] == line[n])
            ++end;
        if (end + 1 == line.size() || !(line[n] > line[n - 1] && line[end] > line[end + 1]))
            continue;
        const auto saddle = [&](auto first, auto last) {
            double low = line[n];
            for (auto value = first; value != last; ++value) {
                if (*value > line[n]) return std::pair{low, true};
                low = std::min(low, *value);
            }
            return std::pair{low, false};
        };
        const auto at = static_cast<std::ptrdiff_t>(n);
        const auto left = saddle(std::make_reverse_iterator(line.begin() + at), line.rend());
        const auto right = saddle(line.begin() + at + 1, line.end());
        const double low = left.second && right.second ? std::max(left.first, right.first)
                           : left.second               ? left.first
                           : right.second              ? right.first
                                                       : std::min(left.first, right.first);
        // Of two equal maxima, the first is taken as the lower one.
        const bool has_equal =
            !left.second && !right.second &&
            std::find(line.begin() + at + static_cast<std::ptrdiff_t>(end - n) + 1, line.end(),
                      line[n]) != line.end();
        if (has_equal) {
            const auto equal = std::find(
                line.begin() + at + static_cast<std::ptrdiff_t>(end - n) + 1, line.end(), line[n]);
            depths.push_back(line[n] - *std::min_element(line.begin() + at, equal));
        } else {
            depths.push_back(line[n] - low);
        }
    }
    std::ranges::sort(depths, std::greater<>{});
    return depths;
}

/// The line on which maxima are counted; empty if there is none.
std::vector<Vec2> counted_line(const Case& c, const std::vector<std::vector<Vec2>>& shapes) {
    if (c.sensation && !c.sensation->line_m.empty()) return c.sensation->line_m;
    if (shapes.size() < 2 ||
        std::ranges::any_of(shapes, [](const auto& shape) { return shape.size() > 1; }))
        return {};
    Vec2 from = shapes[0].front(), to = from;
    for (const auto& a : shapes)
        for (const auto& b : shapes)
            if (norm(b.front() - a.front()) > norm(to - from)) {
                from = a.front();
                to = b.front();
            }
    if (!(norm(to - from) > 0.0)) return {};
    const Vec2 beyond = fwhm_m(c.scene().load.footprint) / norm(to - from) * (to - from);
    return {from - beyond, to + beyond};
}

class FeltColumns {
public:
    FeltColumns(const Case& c, const SensationMap& map)
        : c_(c), map_(map), lines_(sensation_lines(c)), levels_(c, map),
          region_(measured_region(c.domain, c.measure)), fwhm_m_(fwhm_m(c.scene().load.footprint)),
          shapes_(drawn_shape(c.scene().load.modulation, 0.25 * c.domain.spacing_m)),
          reason_(lines_.reason) {
        if (reason_.empty() && map.level_dB.empty())
            reason_ = "the measured region contains no sample";
        else if (reason_.empty() &&
                 std::ranges::none_of(map.level_dB, [](double l) { return std::isfinite(l); }))
            reason_ = fmt::format("nothing moves between {:g} and {:g} Hz",
                                  lines_.bands.front().low_Hz, lines_.bands.back().high_Hz);
    }

    std::vector<Column> take() {
        add_peak();
        add_path();
        add_areas();
        add_widths();
        add_line();
        return std::move(all_);
    }

private:
    void add(const char* name, double value, const std::string& note = "") {
        Column column = column_of(name, reason_.empty() ? value : not_a_number, {});
        column.note = reason_.empty() ? note : reason_;
        if (std::isnan(column.value) && column.note.empty())
            column.note = "nothing moves at a part of the places";
        all_.push_back(std::move(column));
    }
    std::size_t index(std::ptrdiff_t i, std::ptrdiff_t j) const {
        return static_cast<std::size_t>((i - map_.x0) * map_.columns + j - map_.y0);
    }
    /// Calls f(index in the map, i, j, weight) for each sample of the region.
    template <class F>
    void each(F f) const {
        if (!reason_.empty()) return;
        for (std::ptrdiff_t i = region_.x0; i < region_.x1; ++i)
            region_.runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end, double weight) {
                for (std::ptrdiff_t j = first; j < end; ++j)
                    f(index(i, j), i * c_.domain.ny + j, weight);
            });
    }

    void add_peak() {
        double sum_peak = not_a_number, band_Hz = not_a_number;
        each([&](std::size_t n, std::ptrdiff_t, double) {
            if (!(map_.level_dB[n] <= peak_dB_) && std::isfinite(map_.level_dB[n])) {
                peak_dB_ = map_.level_dB[n];
                band_Hz = map_.band_Hz[n];
            }
            sum_peak = std::fmax(sum_peak, map_.sum_dB[n]);
        });
        std::string note;
        if (lines_.is_window && reason_.empty())
            note = fmt::format("from a window of {:.4g} ms, which judges bands from {:g} Hz on",
                               1e3 * lines_.window_s, lines_.bands.front().centre_Hz);
        for (const SensationBand& band : lines_.bands)
            if (band.is_extrapolated && band.centre_Hz == band_Hz)
                note += fmt::format("{}the threshold at {:g} Hz is extrapolated",
                                    note.empty() ? "" : "; ", band_Hz);
        add("felt_peak_dB", peak_dB_, note);
        add("felt_peak_sum_dB", sum_peak);
        add("felt_band_Hz", band_Hz);
    }

    void add_path() {
        double sum = 0.0, power_sum = 0.0, weight = 0.0, outside = 0.0;
        for (const PathPoint& point : path_points(shapes_)) {
            const double level = reason_.empty() ? levels_.level(point.at_m) : not_a_number;
            if (std::isnan(level)) {
                outside += point.weight;
                continue;
            }
            sum += point.weight * level;
            power_sum += point.weight * levels_.at(point.at_m, map_.sum_dB);
            weight += point.weight;
        }
        path_dB_ = sum / weight;
        std::string note;
        if (!(weight > 0.0))
            note = "the path lies outside the measured region";
        else if (outside > 1e-9 * weight)
            note = fmt::format("{:.3g} % of the path lies outside the measured region and is left "
                               "out",
                               100.0 * outside / (outside + weight));
        add("felt_path_dB", path_dB_, note);
        add("felt_path_sum_dB", power_sum / weight, note);
    }

    void add_areas() {
        const double cell_mm2 = std::pow(1e3 * c_.domain.spacing_m, 2);
        constexpr double strong_dB = 6.0;
        double felt = 0.0, strong = 0.0, strong_near = 0.0, far_sum = 0.0, far_weight = 0.0;
        std::vector<double> near, distant;
        if (reason_.empty()) {
            near = shares_near(shapes_, fwhm_m_, c_.domain);
            distant = shares_near(shapes_, 2.0 * fwhm_m_, c_.domain);
        }
        each([&](std::size_t n, std::ptrdiff_t cell, double weight) {
            const double level = map_.level_dB[n];
            if (std::isnan(level)) return;
            const auto at = static_cast<std::size_t>(cell);
            if (level > 0.0) felt += weight;
            if (level > peak_dB_ - strong_dB) {
                strong += weight;
                strong_near += weight * near[at];
            }
            far_sum += weight * (1.0 - distant[at]) * level;
            far_weight += weight * (1.0 - distant[at]);
        });
        add("felt_area_mm2", felt * cell_mm2);
        add("felt_contrast_dB", path_dB_ - far_sum / far_weight,
            far_weight > 0.0 ? "" : "no part of the region is farther than two FWHM from the path");
        add("felt_on_path_1", strong_near / strong);
    }

    void add_widths() {
        constexpr double fewest = 0.5; // share of the path on which the width must exist
        const auto points = path_points(shapes_);
        const auto width = [&](const char* name, double drop_dB) {
            double sum = 0.0, weight = 0.0, all = 0.0;
            for (const PathPoint& point : points)
                for (const Vec2 across : point.across) {
                    const double part = point.weight / static_cast<double>(point.across.size());
                    all += part;
                    const double of_point =
                        reason_.empty() && std::isfinite(levels_.level(point.at_m))
                            ? width_m(levels_, point.at_m, across, fwhm_m_,
                                      0.25 * c_.domain.spacing_m, drop_dB)
                            : not_a_number;
                    if (std::isnan(of_point)) continue;
                    sum += part * of_point;
                    weight += part;
                }
            const bool exists = weight >= fewest * all;
            std::string note;
            if (weight < all * (1.0 - rounding))
                note = fmt::format("across {:.3g} % of the path, the level does not fall by {:g} "
                                   "dB inside the measured region",
                                   100.0 * (1.0 - weight / all), drop_dB);
            add(name, exists ? 1e3 * sum / weight : not_a_number, note);
        };
        width("felt_width_mm", jnd_dB);
        width("felt_width_low_mm", least_jnd_dB);
        width("felt_width_high_mm", largest_jnd_dB);
    }

    void add_line() {
        const std::vector<Vec2> line = counted_line(c_, shapes_);
        std::string note;
        std::vector<double> along;
        if (line.empty()) {
            note = "sensation.line_mm is not given, and the load has no two foci that rest";
        } else if (reason_.empty()) {
            const double steps = std::ceil(norm(line[1] - line[0]) / (0.25 * c_.domain.spacing_m));
            for (double n = 0.0; n <= steps; ++n)
                along.push_back(levels_.level(line[0] + n / steps * (line[1] - line[0])));
            if (std::ranges::any_of(along, [](double l) { return std::isnan(l); }))
                note = "a part of the line lies outside the measured region, or does not move";
        }
        const std::vector<double> depths =
            note.empty() ? prominences(along) : std::vector<double>{};
        const auto peaks = std::ranges::count_if(depths, [](double d) { return d >= jnd_dB; });
        add("felt_peaks_1", note.empty() ? static_cast<double>(peaks) : not_a_number, note);
        add("felt_gap_dB",
            !note.empty()       ? not_a_number
            : depths.size() < 2 ? 0.0
                                : depths[1],
            note);
    }

    const Case& c_;
    const SensationMap& map_;
    SensationLines lines_;
    Levels levels_;
    Region region_;
    double fwhm_m_;
    std::vector<std::vector<Vec2>> shapes_;
    std::string reason_;
    double peak_dB_ = not_a_number, path_dB_ = not_a_number;
    std::vector<Column> all_;
};

} // namespace

std::vector<Column> sensation_columns(const Case& c, const SensationMap& map) {
    return computes_sensation(c) ? FeltColumns(c, map).take() : std::vector<Column>{};
}

} // namespace shearwake::measures
