// SPDX-License-Identifier: BSD-3-Clause
#include "measures/sharpness.hpp"

#include "base/constants.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace shearwake::measures {
namespace {

double squared_distance_m2(Vec2 point, Vec2 from, Vec2 to) {
    const Vec2 along = to - from, there = point - from;
    const double square = dot(along, along);
    const double part = square > 0.0 ? std::clamp(dot(there, along) / square, 0.0, 1.0) : 0.0;
    const Vec2 away = there - part * along;
    return dot(away, away);
}

/// Rows or columns of the samples between two positions, limited to the domain.
struct Cells {
    std::ptrdiff_t first, end;
};
Cells cells_between(double low_m, double high_m, double spacing_m, std::ptrdiff_t count) {
    const auto middle = static_cast<double>(count / 2), most = static_cast<double>(count);
    const double first = std::floor(low_m / spacing_m + middle);
    const double end = std::ceil(high_m / spacing_m + middle) + 1.0;
    return {static_cast<std::ptrdiff_t>(std::clamp(first, 0.0, most)),
            static_cast<std::ptrdiff_t>(std::clamp(end, 0.0, most))};
}

} // namespace

std::vector<double> shares_near(std::span<const std::vector<Vec2>> lines, double reach_m,
                                const Domain& domain) {
    const double h = domain.spacing_m, far = reach_m + h, half = 0.5 * h;
    // Squares of the distances beyond which a cell has no share, and below which it is complete.
    const double none_m2 = std::pow(reach_m + half, 2),
                 all_m2 = reach_m > half ? std::pow(reach_m - half, 2) : -1.0;
    std::vector<double> shares(static_cast<std::size_t>(domain.nx * domain.ny), 0.0);
    const auto mark = [&](Vec2 from, Vec2 to) {
        const Cells rows =
            cells_between(std::min(from.x, to.x) - far, std::max(from.x, to.x) + far, h, domain.nx);
        const Cells columns =
            cells_between(std::min(from.y, to.y) - far, std::max(from.y, to.y) + far, h, domain.ny);
        for (std::ptrdiff_t i = rows.first; i < rows.end; ++i)
            for (std::ptrdiff_t j = columns.first; j < columns.end; ++j) {
                double& share = shares[static_cast<std::size_t>(i * domain.ny + j)];
                if (share == 1.0) continue;
                const double square = squared_distance_m2({domain.x_m(i), domain.y_m(j)}, from, to);
                if (square >= none_m2) continue;
                share = square <= all_m2 ? 1.0
                                         : std::max(share, 0.5 + (reach_m - std::sqrt(square)) / h);
            }
    };
    for (const std::vector<Vec2>& line : lines)
        for (std::size_t n = 0; n < line.size(); ++n)
            mark(line[n], line[std::min(n + 1, line.size() - 1)]);
    return shares;
}

double sharpness(View2<const double> mean_u2, const Domain& domain, const Region& region,
                 std::span<const std::vector<Vec2>> lines, double reach_m) {
    assert(mean_u2.rows() == domain.nx && mean_u2.columns() == domain.ny);
    const std::vector<double> shares = shares_near(lines, reach_m, domain);
    double near = 0.0, all = 0.0;
    for (std::ptrdiff_t i = region.x0; i < region.x1; ++i)
        region.runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end, double weight) {
            for (std::ptrdiff_t j = first; j < end; ++j) {
                const double energy = weight * mean_u2(i, j);
                near += shares[static_cast<std::size_t>(i * domain.ny + j)] * energy;
                all += energy;
            }
        });
    return all > 0.0 ? near / all : not_a_number;
}

} // namespace shearwake::measures
