// SPDX-License-Identifier: BSD-3-Clause
#include "measures/surface_sums.hpp"

#include "measures/disc_fraction.hpp"
#include "measures/kernels/row_sums.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
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

/// Ascending y at which the line of constant x crosses the edges of a polygon.
std::vector<double> row_crossings_m(std::span<const Vec2> corners, double x_m) {
    std::vector<double> crossings;
    for (std::size_t n = 0; n < corners.size(); ++n) {
        const Vec2 a = corners[n], b = corners[(n + 1) % corners.size()];
        if ((a.x <= x_m) == (b.x <= x_m)) continue;
        crossings.push_back(a.y + (x_m - a.x) / (b.x - a.x) * (b.y - a.y));
    }
    std::ranges::sort(crossings);
    return crossings;
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
        runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end) { count += end - first; });
    return count;
}

Region measured_region(const Domain& domain, const MeasureOptions& measure) {
    Region region = measured_region(domain);
    if (measure.region_m.empty()) return region;
    const std::span<const Vec2> corners = measure.region_m;
    // A millionth of a cell, so that rounding does not decide about samples on an edge.
    const double h = domain.spacing_m, slack = 1e-6 * h;
    Region cut = {.x0 = region.x1, .x1 = region.x0, .y0 = region.y1, .y1 = region.y0};
    std::vector<std::vector<SampleRun>> rows;
    for (std::ptrdiff_t i = region.x0; i < region.x1; ++i) {
        std::vector<double> crossings = row_crossings_m(corners, domain.x_m(i) + slack);
        std::vector<SampleRun> row;
        for (std::size_t n = 0; n + 1 < crossings.size(); n += 2) {
            const auto sample = [&](double y_m) {
                const double at = std::ceil((y_m - slack) / h) + static_cast<double>(domain.ny / 2);
                return std::clamp(static_cast<std::ptrdiff_t>(at), region.y0, region.y1);
            };
            const SampleRun run{sample(crossings[n]), sample(crossings[n + 1])};
            if (run.end > run.first) row.push_back(run);
        }
        if (!row.empty()) {
            cut.x0 = std::min(cut.x0, i);
            cut.x1 = i + 1;
            cut.y0 = std::min(cut.y0, row.front().first);
            cut.y1 = std::max(cut.y1, row.back().end);
        }
        rows.push_back(std::move(row));
    }
    if (cut.x1 <= cut.x0)
        return {.x0 = region.x0, .x1 = region.x0, .y0 = region.y0, .y1 = region.y0};
    cut.cut.assign(rows.begin() + (cut.x0 - region.x0), rows.begin() + (cut.x1 - region.x0));
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
        region.runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
            kernels.row_sums(slab.row(i - x_start).data() + first, last - first, of_row);
            u.add(total(of_row.u));
            abs_u.add(total(of_row.abs_u));
            u2.add(total(of_row.u2));
            u4.add(total(of_row.u4));
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
            sums.focal_peak = std::max(sums.focal_peak, std::abs(value));
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
