// SPDX-License-Identifier: BSD-3-Clause
#include "neural/hand/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::neural {
namespace {

double cross(Vec2 a, Vec2 b) {
    return a.x * b.y - a.y * b.x;
}

/// Calls visit(from, to) for every side.
template <class Visit>
void each_side(const Polygon& polygon, const Visit& visit) {
    for (std::size_t i = 0; i < polygon.size(); ++i)
        visit(polygon[i], polygon[(i + 1) % polygon.size()]);
}

double signed_area(const Polygon& polygon) {
    double twice = 0.0;
    each_side(polygon, [&](Vec2 a, Vec2 b) { twice += cross(a, b); });
    return 0.5 * twice;
}

} // namespace

double area(const Polygon& polygon) {
    return std::abs(signed_area(polygon));
}

Vec2 centroid(const Polygon& polygon) {
    Vec2 sum;
    each_side(polygon, [&](Vec2 a, Vec2 b) { sum = sum + cross(a, b) * (a + b); });
    return 1.0 / (6.0 * signed_area(polygon)) * sum;
}

Box bounding_box(const Polygon& polygon) {
    Box box{polygon.front(), polygon.front()};
    for (const Vec2 p : polygon) {
        box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
        box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
    }
    return box;
}

bool contains(const Polygon& polygon, Vec2 point) {
    bool within = false; // an odd number of sides crosses the ray from the point along x
    each_side(polygon, [&](Vec2 a, Vec2 b) {
        if ((a.y > point.y) == (b.y > point.y)) return;
        const double x = a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x);
        if (point.x < x) within = !within;
    });
    return within;
}

} // namespace shearwake::neural
