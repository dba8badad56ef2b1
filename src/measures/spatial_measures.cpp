// SPDX-License-Identifier: BSD-3-Clause
#include "measures/spatial_measures.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace shearwake::measures {

double impulse_N_s(const Load& load, double until_s) {
    constexpr double steps_a_period = 100.0, fewest_steps = 10000.0;
    constexpr std::size_t most_rough = 400;
    const double end = std::min(until_s, off_time_s(load.modulation.trajectory));
    if (!(end > 0.0)) return 0.0;
    const double highest_Hz = greatest_envelope_frequency_Hz(load.modulation.envelope) +
                              carrier_frequency_Hz(load.carrier);

    // The Gauss rule of two points in each step. The many steps are for the jumps of a steered
    // array's force by up to a few per cent, where its focus is updated or its path begins again.
    const double steps = std::ceil(std::max(fewest_steps, steps_a_period * highest_Hz * end));
    const double dt_s = end / steps;
    std::vector<double> times_s;
    for (double n = 0.0; n < steps; n += 1.0)
        for (const double side : {-1.0, 1.0})
            times_s.push_back((n + 0.5 + 0.5 * side / std::numbers::sqrt3) * dt_s);
    const std::vector<double> areas_m2 = force_areas_m2(load, times_s, most_rough);
    double sum = 0.0;
    for (std::size_t n = 0; n < times_s.size(); ++n)
        sum += areas_m2[n] * amplitude(load, times_s[n]);
    return load.peak_Pa * sum * 0.5 * dt_s;
}

namespace {

double cross(Vec2 a, Vec2 b) {
    return a.x * b.y - a.y * b.x;
}

/// Signed area of the sector of the unit disc from direction a to direction b.
double sector(Vec2 a, Vec2 b) {
    return 0.5 * std::atan2(cross(a, b), dot(a, b));
}

/// Signed area shared by the unit disc about the origin and the triangle (origin, a, b): the edge
/// is split where it crosses the circle; parts inside contribute triangles, parts outside
/// contribute sectors.
double triangle_in_disc(Vec2 a, Vec2 b) {
    const Vec2 d = b - a;
    // |a + t d|^2 = 1
    const double dd = dot(d, d), ad = dot(a, d);
    const double discriminant = ad * ad - dd * (dot(a, a) - 1.0);
    if (!(discriminant > 0.0)) return sector(a, b);
    const double root = std::sqrt(discriminant);
    const double enter = (-ad - root) / dd, leave = (-ad + root) / dd;
    if (enter >= 1.0 || leave <= 0.0) return sector(a, b);
    const Vec2 first = enter > 0.0 ? a + enter * d : a;
    const Vec2 last = leave < 1.0 ? a + leave * d : b;
    double area = 0.5 * cross(first, last);
    if (enter > 0.0) area += sector(a, first);
    if (leave < 1.0) area += sector(last, b);
    return area;
}

} // namespace

double disc_fraction(double x_m, double y_m, double spacing_m, Vec2 centre, double radius_m) {
    if (!(radius_m > 0.0)) return 0.0;
    // All lengths are in units of the radius, relative to the centre of the disc.
    const double half = 0.5 * spacing_m / radius_m;
    const double x = (x_m - centre.x) / radius_m, y = (y_m - centre.y) / radius_m;
    const double near_x = std::max(0.0, std::abs(x) - half);
    const double near_y = std::max(0.0, std::abs(y) - half);
    if (near_x * near_x + near_y * near_y >= 1.0) return 0.0;
    const double far_x = std::abs(x) + half, far_y = std::abs(y) + half;
    if (far_x * far_x + far_y * far_y <= 1.0) return 1.0;

    const std::array<Vec2, 4> corner = {
        {{x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}}};
    double area = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
        area += triangle_in_disc(corner[i], corner[(i + 1) % 4]);
    return std::clamp(area / (4.0 * half * half), 0.0, 1.0);
}

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
