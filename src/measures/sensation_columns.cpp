// SPDX-License-Identifier: BSD-3-Clause
#include "measures/sensation.hpp"

#include "base/units.hpp"
#include "measures/measure_table.hpp"
#include "measures/spatial_measures.hpp"
#include "measures/summary.hpp"
#include "problem/load/footprint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <iterator>
#include <limits>
#include <numbers>

namespace shearwake::measures {
namespace {

constexpr double rounding_of_weights = 1e-9; // relative
constexpr double strong_dB = 6.0;            // below the largest level

/// Levels between the samples, by interpolation of the power.
class Levels {
public:
    Levels(const Case& c, const SensationMap& map) : domain_(c.domain), map_(map) {}

    /// Bilinear; NaN outside the rectangle or where nothing moves.
    double interpolate(Vec2 place_m, const std::vector<double>& levels_dB) const {
        const double x = place_m.x / domain_.spacing_m +
                         static_cast<double>(domain_.nx / 2 - map_.x0),
                     y = place_m.y / domain_.spacing_m +
                         static_cast<double>(domain_.ny / 2 - map_.y0);
        constexpr double edge = 1e-9;
        if (!(x >= -edge && y >= -edge && x <= static_cast<double>(map_.rows - 1) + edge &&
              y <= static_cast<double>(map_.columns - 1) + edge))
            return not_a_number;
        const auto cell = [](double v, std::ptrdiff_t count) {
            const double last = static_cast<double>(count - 1), in = std::clamp(v, 0.0, last);
            const double low = std::min(std::floor(in), std::max(last - 1.0, 0.0));
            return std::pair{static_cast<std::ptrdiff_t>(low), in - low};
        };
        const auto [i, u] = cell(x, map_.rows);
        const auto [j, v] = cell(y, map_.columns);
        double sum = 0.0;
        for (const auto& [di, wx] : {std::pair{0, 1.0 - u}, std::pair{1, u}})
            for (const auto& [dj, wy] : {std::pair{0, 1.0 - v}, std::pair{1, v}})
                if (wx * wy > 0.0)
                    sum += wx * wy *
                           std::pow(10.0, 0.1 * levels_dB[static_cast<std::size_t>(
                                                    (i + di) * map_.columns + j + dj)]);
        return 10.0 * std::log10(sum);
    }
    double level(Vec2 place_m) const { return interpolate(place_m, map_.level_dB); }

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

using Widths = std::array<double, 3>;

/// The widths of the profile through a point around its largest value within `near_m`, at each of
/// the drops [dB] below that value, which increase; NaN if it does not fall that far inside the
/// map.
Widths widths_m(const Levels& levels, Vec2 at_m, Vec2 across, double near_m, double step_m,
                const Widths& drops_dB) {
    double top = levels.level(at_m), top_at = 0.0;
    for (double s = -near_m; s <= near_m; s += step_m)
        if (const double level = levels.level(at_m + s * across); level > top) {
            top = level;
            top_at = s;
        }
    Widths widths = {};
    for (const double side : {-1.0, 1.0}) {
        double before = top;
        std::size_t n = 0;
        for (double s = step_m; n < widths.size(); s += step_m) {
            const double level = levels.level(at_m + (top_at + side * s) * across);
            for (; n < widths.size() && !(level >= top - drops_dB[n]); ++n) // also NaN
                widths[n] += s - step_m * (top - drops_dB[n] - level) / (before - level);
            before = level;
        }
    }
    return widths;
}

struct Maximum {
    double level = 0.0;
    double depth = 0.0; // of the saddle to a higher one; of the highest, above the lowest value
};

/// The maxima inside a line, the deepest saddle first.
std::vector<Maximum> maxima(const std::vector<double>& line) {
    std::vector<Maximum> found;
    for (std::size_t n = 1; n + 1 < line.size(); ++n) {
        std::size_t end = n; // of a plateau
        while (end + 1 < line.size() && line[end + 1] == line[n])
            ++end;
        if (end + 1 == line.size() || !(line[n] > line[n - 1] && line[end] > line[end + 1]))
            continue;
        // The lowest value before a higher one. Of equal maxima, the last is taken as the highest.
        const auto saddle = [&](auto value, auto last, bool or_equal) {
            double low = line[n];
            for (; value != last; low = std::min(low, *value++))
                if (*value > line[n] || (or_equal && *value == line[n])) return low;
            return -std::numeric_limits<double>::infinity();
        };
        const auto at = line.begin() + static_cast<std::ptrdiff_t>(n);
        double low =
            std::max(saddle(std::make_reverse_iterator(at), line.rend(), false),
                     saddle(line.begin() + static_cast<std::ptrdiff_t>(end) + 1, line.end(), true));
        if (std::isinf(low)) low = std::ranges::min(line);
        found.push_back({line[n], line[n] - low});
    }
    std::ranges::sort(found, std::greater<>{}, &Maximum::depth);
    return found;
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
    const Vec2 beyond = fwhm_m(c.scene.load.footprint) / norm(to - from) * (to - from);
    return {from - beyond, to + beyond};
}

class PerceptionColumns {
public:
    PerceptionColumns(const Case& c, const SensationMap& map)
        : c_(c), map_(map), lines_(sensation_lines(c)), levels_(c, map),
          region_(measured_region(c.domain, c.measure)), fwhm_m_(fwhm_m(c.scene.load.footprint)),
          shapes_(drawn_shape(c.scene.load.modulation, 0.25 * c.domain.spacing_m)),
          reason_(lines_.reason) {
        if (reason_.empty() && map.level_dB.empty())
            reason_ = "the measured region contains no sample";
        else if (reason_.empty() &&
                 std::ranges::none_of(map.level_dB, [](double l) { return std::isfinite(l); }))
            reason_ = fmt::format("nothing moves between {:g} and {:g} Hz",
                                  lines_.bands.front().low_Hz, lines_.bands.back().high_Hz);
    }

    std::vector<Column> columns() {
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
        if (!lines_.repeats && reason_.empty())
            note = fmt::format("from the {:.4g} ms before measure.at_ms: the level of the steady "
                               "state if the motion has settled",
                               1e3 * lines_.window_s);
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
            power_sum += point.weight * levels_.interpolate(point.at_m, map_.sum_dB);
            weight += point.weight;
        }
        path_dB_ = sum / weight;
        std::string& note = path_note_;
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
        double above = 0.0, strong = 0.0, strong_near = 0.0, far_sum = 0.0, far_weight = 0.0;
        std::vector<double> near, distant;
        if (reason_.empty()) {
            near = shares_near(shapes_, fwhm_m_, c_.domain);
            distant = shares_near(shapes_, 2.0 * fwhm_m_, c_.domain);
        }
        each([&](std::size_t n, std::ptrdiff_t cell, double weight) {
            const double level = map_.level_dB[n];
            if (std::isnan(level)) return;
            const auto at = static_cast<std::size_t>(cell);
            if (level > 0.0) above += weight;
            if (level > peak_dB_ - strong_dB) {
                strong += weight;
                strong_near += weight * near[at];
            }
            far_sum += weight * (1.0 - distant[at]) * level;
            far_weight += weight * (1.0 - distant[at]);
        });
        add("felt_area_mm2", above * cell_mm2);
        add("felt_contrast_dB", path_dB_ - far_sum / far_weight,
            far_weight > 0.0 ? path_note_
                             : "no part of the region is farther than two FWHM from the path");
        add("felt_on_path_1", strong_near / strong);
    }

    void add_widths() {
        constexpr double fewest = 0.5; // share of the path on which the width must exist
        constexpr Widths drops_dB = {least_jnd_dB, jnd_dB, largest_jnd_dB};
        Widths sums = {}, weights = {};
        double all = 0.0;
        for (const PathPoint& point : path_points(shapes_))
            for (const Vec2 across : point.across) {
                const double part = point.weight / static_cast<double>(point.across.size());
                all += part;
                if (!reason_.empty() || !std::isfinite(levels_.level(point.at_m))) continue;
                const Widths widths = widths_m(levels_, point.at_m, across, fwhm_m_,
                                               0.25 * c_.domain.spacing_m, drops_dB);
                for (std::size_t n = 0; n < widths.size(); ++n) {
                    if (std::isnan(widths[n])) continue;
                    sums[n] += part * widths[n];
                    weights[n] += part;
                }
            }
        const auto add_width = [&](const char* name, std::size_t n) {
            std::string note;
            if (std::isnan(path_dB_))
                note = path_note_;
            else if (weights[n] < all * (1.0 - rounding_of_weights))
                note = fmt::format("across {:.3g} % of the path, the level does not fall by {:g} "
                                   "dB inside the measured region",
                                   100.0 * (1.0 - weights[n] / all), drops_dB[n]);
            add(name, weights[n] >= fewest * all ? 1e3 * sums[n] / weights[n] : not_a_number, note);
        };
        add_width("felt_width_mm", 1);
        add_width("felt_width_low_mm", 0);
        add_width("felt_width_high_mm", 2);
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
        const std::vector<Maximum> found = note.empty() ? maxima(along) : std::vector<Maximum>{};
        const auto peaks = std::ranges::count_if(found, [&](const Maximum& m) {
            return m.depth >= jnd_dB && m.level > std::ranges::max(along) - strong_dB;
        });
        add("felt_peaks_1", note.empty() ? static_cast<double>(peaks) : not_a_number, note);
        add("felt_gap_dB",
            !note.empty()      ? not_a_number
            : found.size() < 2 ? 0.0
                               : found[1].depth,
            note);
    }

    const Case& c_;
    const SensationMap& map_;
    SensationLines lines_;
    Levels levels_;
    Region region_;
    double fwhm_m_;
    std::vector<std::vector<Vec2>> shapes_;
    std::string reason_, path_note_;
    double peak_dB_ = not_a_number, path_dB_ = not_a_number;
    std::vector<Column> all_;
};

} // namespace

std::vector<Column> sensation_columns(const Case& c, const SensationMap& map) {
    return computes_sensation(c) ? PerceptionColumns(c, map).columns() : std::vector<Column>{};
}

} // namespace shearwake::measures
