// SPDX-License-Identifier: BSD-3-Clause
#include "measures/surface_sums.hpp"

#include "measures/kernels/row_sums.hpp"
#include "measures/spatial_measures.hpp"
#include "simd/kernels.hpp"

#include <cmath>
#include <iterator>
#include <utility>

namespace shearwake::measures {
namespace {

/// Compensated summation (Neumaier 1974).
class CompensatedSum {
public:
    void add(double value) {
        const double total = sum_ + value;
        lost_ +=
            std::abs(sum_) >= std::abs(value) ? (sum_ - total) + value : (value - total) + sum_;
        sum_ = total;
    }
    double value() const { return sum_ + lost_; }

private:
    double sum_ = 0.0;
    double lost_ = 0.0;
};

double total(const Block& a) {
    return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

/// First index whose cell reaches beyond `from`, and one after the last that reaches below `to`, on
/// a grid of n samples centred on the origin; one additional cell on each side does no harm.
std::pair<std::ptrdiff_t, std::ptrdiff_t> index_range(double from, double to, double spacing,
                                                      std::ptrdiff_t n) {
    const double middle = static_cast<double>(n / 2), last = static_cast<double>(n);
    const double first = std::clamp(std::floor(from / spacing + middle - 0.5), 0.0, last);
    const double end = std::clamp(std::ceil(to / spacing + middle + 1.5), first, last);
    return {static_cast<std::ptrdiff_t>(first), static_cast<std::ptrdiff_t>(end)};
}

/// The mean of min(max(s, 0), 1) over s between a and b.
double mean_of_clamped(double a, double b) {
    const auto integral = [](double s) {
        return s <= 0.0 ? 0.0 : s >= 1.0 ? s - 0.5 : 0.5 * s * s;
    };
    if (std::max(a, b) <= 0.0) return 0.0;
    if (std::min(a, b) >= 1.0) return 1.0;
    if (std::abs(b - a) < 1e-7) return std::clamp(0.5 * (a + b), 0.0, 1.0);
    return (integral(b) - integral(a)) / (b - a);
}

/// The first `count` cells of row i inside a polygon in units of cells, where cell (i, j) is the
/// square [i, i + 1] x [j, j + 1]: the sum over the edges of the signed area of the cell below
/// each.
std::vector<SampleRun> row_inside(std::span<const Vec2> corners, std::ptrdiff_t i,
                                  std::ptrdiff_t count) {
    std::vector<double> inside(static_cast<std::size_t>(count), 0.0);
    const auto left = static_cast<double>(i);
    for (std::size_t n = 0; n < corners.size(); ++n) {
        const Vec2 a = corners[n], b = corners[(n + 1) % corners.size()];
        const double from = std::clamp(a.x, left, left + 1.0),
                     to = std::clamp(b.x, left, left + 1.0);
        if (from == to) continue;
        const double slope = (b.y - a.y) / (b.x - a.x);
        const double y_from = a.y + slope * (from - a.x), y_to = a.y + slope * (to - a.x);
        for (std::size_t j = 0; j < inside.size(); ++j) {
            const auto low = static_cast<double>(j);
            inside[j] += (to - from) * mean_of_clamped(y_from - low, y_to - low);
        }
    }
    // A millionth of a cell, so that rounding does not decide about samples.
    constexpr double slack = 1e-6;
    std::vector<SampleRun> runs;
    for (std::ptrdiff_t j = 0; j < count; ++j) {
        double weight = std::abs(inside[static_cast<std::size_t>(j)]);
        if (weight < slack) continue;
        if (weight > 1.0 - slack) weight = 1.0;
        if (!runs.empty() && runs.back().end == j && runs.back().weight == weight)
            ++runs.back().end;
        else
            runs.push_back({j, j + 1, weight});
    }
    return runs;
}

/// The part of a polygon on the side of a line where dot(normal, point) <= limit (Sutherland and
/// Hodgman 1974). Parts that a concave polygon leaves are connected by edges without area.
std::vector<Vec2> clipped(const std::vector<Vec2>& corners, Vec2 normal, double limit) {
    std::vector<Vec2> part;
    for (std::size_t n = 0; n < corners.size(); ++n) {
        const Vec2 a = corners[n], b = corners[(n + 1) % corners.size()];
        const double beyond_a = dot(normal, a) - limit, beyond_b = dot(normal, b) - limit;
        if (beyond_a <= 0.0) part.push_back(a);
        if (std::min(beyond_a, beyond_b) < 0.0 && std::max(beyond_a, beyond_b) > 0.0)
            part.push_back(a + (beyond_a / (beyond_a - beyond_b)) * (b - a));
    }
    return part;
}

} // namespace

Region measured_region(const Domain& domain) {
    // A tolerance of a millionth of a cell, so that a sponge of a whole number of cells covers
    // exactly these.
    const auto margin =
        static_cast<std::ptrdiff_t>(std::ceil(domain.sponge_m / domain.spacing_m - 1e-6));
    const auto inside = [&](std::ptrdiff_t n) {
        const std::ptrdiff_t low = std::min(margin, n / 2);
        return std::pair{low, std::max(low, n - margin)};
    };
    const auto [x0, x1] = inside(domain.nx);
    const auto [y0, y1] = inside(domain.ny);
    return {.x0 = x0, .x1 = x1, .y0 = y0, .y1 = y1};
}

std::ptrdiff_t Region::samples() const {
    std::ptrdiff_t count = 0;
    for (std::ptrdiff_t i = x0; i < x1; ++i)
        runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end, double) { count += end - first; });
    return count;
}

double Region::cells() const {
    CompensatedSum sum;
    for (std::ptrdiff_t i = x0; i < x1; ++i)
        runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end, double weight) {
            sum.add(weight * static_cast<double>(end - first));
        });
    return sum.value();
}

std::vector<Vec2> measured_outline(const Domain& domain, const MeasureOptions& measure) {
    const double half_cell_m = 0.5 * domain.spacing_m;
    if (measure.region_m.empty()) {
        const Region region = measured_region(domain);
        if (region.samples() == 0) return {};
        const double low_x = domain.x_m(region.x0) - half_cell_m,
                     high_x = domain.x_m(region.x1) - half_cell_m,
                     low_y = domain.y_m(region.y0) - half_cell_m,
                     high_y = domain.y_m(region.y1) - half_cell_m;
        return {{low_x, low_y}, {high_x, low_y}, {high_x, high_y}, {low_x, high_y}};
    }
    const double margin_m = std::max(domain.sponge_m, half_cell_m);
    const double far_x = 0.5 * domain.extent_x_m() - margin_m,
                 far_y = 0.5 * domain.extent_y_m() - margin_m;
    std::vector<Vec2> corners = clipped(measure.region_m, {1.0, 0.0}, far_x);
    corners = clipped(corners, {-1.0, 0.0}, far_x);
    corners = clipped(corners, {0.0, 1.0}, far_y);
    return clipped(corners, {0.0, -1.0}, far_y);
}

Region measured_region(const Domain& domain, const MeasureOptions& measure) {
    if (measure.region_m.empty()) return measured_region(domain);
    std::vector<Vec2> corners = measured_outline(domain, measure);
    const Vec2 origin{static_cast<double>(domain.nx / 2) + 0.5,
                      static_cast<double>(domain.ny / 2) + 0.5};
    for (Vec2& corner : corners)
        corner = (1.0 / domain.spacing_m) * corner + origin; // cell (0, 0) begins at 0
    Region cut = {.x0 = domain.nx, .x1 = 0, .y0 = domain.ny, .y1 = 0};
    std::vector<std::vector<SampleRun>> rows;
    for (std::ptrdiff_t i = 0; i < domain.nx; ++i) {
        rows.push_back(row_inside(corners, i, domain.ny));
        if (rows.back().empty()) continue;
        cut.x0 = std::min(cut.x0, i);
        cut.x1 = i + 1;
        cut.y0 = std::min(cut.y0, rows.back().front().first);
        cut.y1 = std::max(cut.y1, rows.back().back().end);
    }
    if (cut.x1 <= cut.x0) return {};
    cut.cut.assign(rows.begin() + cut.x0, rows.begin() + cut.x1);
    const std::vector<SampleRun> full = {{cut.y0, cut.y1}};
    if (std::ranges::all_of(cut.cut, [&](const auto& row) { return row == full; })) cut.cut.clear();
    return cut;
}

FocalRegion::FocalRegion(const Domain& domain, const Region& region, std::span<const Vec2> foci_m,
                         double radius_m)
    : domain_(domain), region_(region), foci_m_(foci_m), radius_m_(radius_m) {
    if (foci_m.empty()) return;
    Vec2 low = foci_m.front(), high = low;
    for (const Vec2& focus : foci_m) {
        low = {std::min(low.x, focus.x), std::min(low.y, focus.y)};
        high = {std::max(high.x, focus.x), std::max(high.y, focus.y)};
    }
    const double h = domain.spacing_m;
    const auto of_x = index_range(low.x - radius_m, high.x + radius_m, h, domain.nx);
    const auto of_y = index_range(low.y - radius_m, high.y + radius_m, h, domain.ny);
    x_first = std::max(of_x.first, region.x0);
    x_end = std::min(of_x.second, region.x1);
    y_first_ = of_y.first;
    y_end_ = of_y.second;
}

double FocalRegion::fraction(std::ptrdiff_t i, std::ptrdiff_t j) const {
    double w = 0.0;
    for (const Vec2& focus : foci_m_)
        w += disc_fraction(domain_.x_m(i), domain_.y_m(j), domain_.spacing_m, focus, radius_m_);
    return std::min(w, 1.0);
}

SurfaceSums surface_sums(View2<const double> slab, std::ptrdiff_t x_start, const Domain& domain,
                         const Region& region, Vec2 focus_m, double focal_radius_m) {
    return surface_sums(slab, x_start, domain, region, std::span(&focus_m, 1), focal_radius_m);
}

SurfaceSums surface_sums(View2<const double> slab, std::ptrdiff_t x_start, const Domain& domain,
                         const Region& region, std::span<const Vec2> foci_m,
                         double focal_radius_m) {
    const std::ptrdiff_t begin = std::max(region.x0, x_start);
    const std::ptrdiff_t end = std::min(region.x1, x_start + slab.rows());

    const RowSumKernels& kernels = simd::kernels<RowSumKernels>();
    RowSums8 of_row;
    SurfaceSums sums;
    CompensatedSum u, abs_u, u2, u4;
    for (std::ptrdiff_t i = begin; i < end; ++i)
        region.runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t last, double weight) {
            kernels.row_sums(slab.row(i - x_start).data() + first, last - first, of_row);
            u.add(weight * total(of_row.u));
            abs_u.add(weight * total(of_row.abs_u));
            u2.add(weight * total(of_row.u2));
            u4.add(weight * total(of_row.u4));
            sums.peak = std::max(sums.peak, *std::ranges::max_element(of_row.peak.lane));
        });
    sums.u = u.value();
    sums.abs_u = abs_u.value();
    sums.u2 = u2.value();
    sums.u4 = u4.value();

    if (foci_m.empty()) return sums;
    const FocalRegion focal(domain, region, foci_m, focal_radius_m);
    CompensatedSum focal_u2, focal_weight;
    for (std::ptrdiff_t i = std::max(begin, focal.x_first); i < std::min(end, focal.x_end); ++i) {
        double row_u2 = 0.0, row_weight = 0.0;
        focal.row(i, [&](std::ptrdiff_t j, double w) {
            const double value = slab(i - x_start, j);
            row_u2 += w * value * value;
            row_weight += w;
        });
        focal_u2.add(row_u2);
        focal_weight.add(row_weight);
    }
    sums.focal_u2 = focal_u2.value();
    sums.focal_weight = focal_weight.value();
    return sums;
}

SurfaceSums combine(const SurfaceSums& a, const SurfaceSums& b) {
    SurfaceSums both;
    for (const auto& [value, reduction] : sum_parts)
        both.*value =
            reduction == Reduction::sum ? a.*value + b.*value : std::max(a.*value, b.*value);
    return both;
}

} // namespace shearwake::measures
