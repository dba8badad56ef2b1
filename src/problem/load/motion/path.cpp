// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/motion/path.hpp"

#include "base/error.hpp"
#include "base/field.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake {
namespace {

/// Smaller turns are not corners, so that the points of a sampled curve are not.
constexpr double least_turn_rad = to_radians(20.0);

Vec2 unit(Vec2 along) {
    const double length = norm(along);
    return length > 0.0 ? (1.0 / length) * along : Vec2{1.0, 0.0};
}

bool turns(Vec2 before, Vec2 after) {
    const double cross = before.x * after.y - before.y * after.x;
    return std::abs(std::atan2(cross, dot(before, after))) >= least_turn_rad * (1.0 - 1e-9);
}

Vec2 at_angle(double radius_m, double angle_rad) {
    return {radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad)};
}

double angle_rad(const Arc& arc, double arc_m) {
    const double turned = arc.radius_m > 0.0 ? arc_m / arc.radius_m : 0.0;
    return arc.start_rad + std::copysign(turned, arc.sweep_rad);
}

Vec2 scaled(Vec2 point, Vec2 centre, double factor) {
    return centre + factor * (point - centre);
}

/// The shape that has corners; null if the path is smooth.
const Polyline* as_polyline(const Curve& path) {
    constexpr auto smooth = []() -> const Polyline* { return nullptr; };
    return std::visit(overloaded{[&](const Line&) { return smooth(); },
                                 [&](const Arc&) { return smooth(); },
                                 [](const Polyline& line) { return &line; },
                                 [&](const Lissajous&) { return smooth(); }},
                      path.shape);
}

} // namespace

Polyline::Polyline(std::vector<Vec2> points_m, Ends ends)
    : points_m_(std::move(points_m)), ends_(ends) {
    if (points_m_.size() < 2) throw Error("a polyline of fewer than two points");
    const std::size_t pieces = points_m_.size() - (ends == Ends::open ? 1 : 0);
    arcs_m_.push_back(0.0);
    for (std::size_t i = 0; i < pieces; ++i)
        arcs_m_.push_back(arcs_m_.back() + norm(point(i + 1) - point(i)));
    for (std::size_t i = 1; i < pieces; ++i)
        if (turns(direction(i - 1), direction(i))) corners_m_.push_back(arcs_m_[i]);
    starts_at_corner_ = ends == Ends::closed && turns(direction(pieces - 1), direction(0));
}

std::size_t Polyline::piece(double arc_m) const {
    const auto above = std::upper_bound(arcs_m_.begin() + 1, arcs_m_.end() - 1, arc_m);
    return static_cast<std::size_t>(above - arcs_m_.begin()) - 1;
}

Vec2 Polyline::direction(std::size_t piece) const {
    return unit(point(piece + 1) - point(piece));
}

Vec2 Polyline::at(double arc_m) const {
    const std::size_t i = piece(arc_m);
    return point(i) + (arc_m - arcs_m_[i]) * direction(i);
}

Vec2 Polyline::tangent(double arc_m) const {
    return direction(piece(arc_m));
}

double length_m(const Curve& path) {
    return std::visit(overloaded{
                          [](const Line& line) { return norm(line.to_m - line.from_m); },
                          [](const Arc& arc) { return arc.radius_m * std::abs(arc.sweep_rad); },
                          [](const auto& curve) { return curve.length_m(); },
                      },
                      path.shape);
}

Vec2 point_m(const Curve& path, double arc_m) {
    return std::visit(
        overloaded{
            [&](const Line& line) { return line.from_m + arc_m * unit(line.to_m - line.from_m); },
            [&](const Arc& arc) {
                const double end_m = length_m(path);
                const double on_m = std::clamp(arc_m, 0.0, end_m);
                const Vec2 on_curve = arc.center_m + at_angle(arc.radius_m, angle_rad(arc, on_m));
                return on_m == arc_m ? on_curve : on_curve + (arc_m - on_m) * tangent(path, arc_m);
            },
            [&](const auto& curve) { return curve.at(arc_m); },
        },
        path.shape);
}

Vec2 tangent(const Curve& path, double arc_m) {
    return std::visit(overloaded{
                          [&](const Line& line) { return unit(line.to_m - line.from_m); },
                          [&](const Arc& arc) {
                              const double on_m = std::clamp(arc_m, 0.0, length_m(path));
                              const Vec2 out = at_angle(1.0, angle_rad(arc, on_m));
                              return std::copysign(1.0, arc.sweep_rad) * Vec2{-out.y, out.x};
                          },
                          [&](const auto& curve) { return curve.tangent(arc_m); },
                      },
                      path.shape);
}

std::ptrdiff_t smooth_piece(const Curve& path, double arc_m) {
    const Polyline* line = as_polyline(path);
    return line ? static_cast<std::ptrdiff_t>(line->piece(arc_m)) : 0;
}

bool is_closed(const Curve& path) {
    return std::visit(
        overloaded{
            [](const Line&) { return false; },
            [](const Arc& arc) { return std::abs(arc.sweep_rad) >= two_pi * (1.0 - 1e-12); },
            [](const Polyline& line) { return line.ends() == Ends::closed; },
            [](const Lissajous&) { return true; },
        },
        path.shape);
}

std::span<const double> corners_m(const Curve& path) {
    const Polyline* line = as_polyline(path);
    return line ? line->corners_m() : std::span<const double>{};
}

bool starts_at_corner(const Curve& path) {
    const Polyline* line = as_polyline(path);
    return line && line->starts_at_corner();
}

Curve scaled(const Curve& path, double factor) {
    return std::visit(
        overloaded{
            [&](const Line& line) -> Curve {
                const Vec2 centre = 0.5 * (line.from_m + line.to_m);
                return Line{scaled(line.from_m, centre, factor), scaled(line.to_m, centre, factor)};
            },
            [&](Arc arc) -> Curve {
                arc.radius_m *= factor;
                return arc;
            },
            [&](const Polyline& polyline) -> Curve {
                Vec2 low = polyline.points_m().front(), high = low;
                for (const Vec2& point : polyline.points_m()) {
                    low = {std::min(low.x, point.x), std::min(low.y, point.y)};
                    high = {std::max(high.x, point.x), std::max(high.y, point.y)};
                }
                std::vector<Vec2> points_m;
                for (const Vec2& point : polyline.points_m())
                    points_m.push_back(scaled(point, 0.5 * (low + high), factor));
                return Polyline(std::move(points_m), polyline.ends());
            },
            [&](const Lissajous& lissajous) -> Curve {
                LissajousShape shape = lissajous.shape();
                shape.amplitudes_m = factor * shape.amplitudes_m;
                return Lissajous(shape);
            }},
        path.shape);
}

Polyline regular_polygon(Vec2 center_m, double radius_m, int corners, double start_rad) {
    std::vector<Vec2> points_m;
    for (int i = 0; i < corners; ++i)
        points_m.push_back(center_m + at_angle(radius_m, start_rad + two_pi * i / corners));
    return {std::move(points_m), Ends::closed};
}

} // namespace shearwake
