// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/orientation.hpp"

#include "base/vectors.hpp"

#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

/// cos and sin of an angle, exact along the axes.
Vec2 direction(double angle_deg) {
    const double turn_deg = std::remainder(angle_deg, 360.0);
    if (turn_deg == 0.0) return {1.0, 0.0};
    if (std::abs(turn_deg) == 90.0) return {0.0, std::copysign(1.0, turn_deg)};
    if (std::abs(turn_deg) == 180.0) return {-1.0, 0.0};
    const double turn_rad = turn_deg * std::numbers::pi / 180.0;
    return {std::cos(turn_rad), std::sin(turn_rad)};
}

} // namespace

BodyAxes axes_of(const Orientation& orientation) {
    const Vec2 turn = direction(orientation.azimuth_deg),
               tilt = direction(orientation.inclination_deg),
               roll = direction(orientation.roll_deg);
    const Vec3 x{turn.x * tilt.x, turn.y * tilt.x, tilt.y};
    const Vec3 across{-turn.y, turn.x, 0.0};
    const Vec3 down{-turn.x * tilt.y, -turn.y * tilt.y, tilt.x};
    return {x, roll.x * across + roll.y * down, roll.x * down - roll.y * across};
}

} // namespace shearwake
