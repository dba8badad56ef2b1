// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace shearwake {

/// A point or a displacement on the skin surface [m], or a velocity [m/s].
struct Vec2 {
    double x = 0.0;
    double y = 0.0;
    bool operator==(const Vec2&) const = default;
};

constexpr Vec2 operator+(Vec2 a, Vec2 b) {
    return {a.x + b.x, a.y + b.y};
}
constexpr Vec2 operator-(Vec2 a, Vec2 b) {
    return {a.x - b.x, a.y - b.y};
}
constexpr Vec2 operator*(double s, Vec2 a) {
    return {s * a.x, s * a.y};
}
constexpr double dot(Vec2 a, Vec2 b) {
    return a.x * b.x + a.y * b.y;
}
inline double norm(Vec2 a) {
    return std::hypot(a.x, a.y);
}

} // namespace shearwake
