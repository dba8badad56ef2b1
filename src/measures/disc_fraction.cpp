// SPDX-License-Identifier: BSD-3-Clause
#include "measures/disc_fraction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace shearwake::measures {
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

} // namespace shearwake::measures
