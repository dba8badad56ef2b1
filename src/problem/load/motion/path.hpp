// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"
#include "problem/load/motion/lissajous.hpp"

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

namespace shearwake {

/// A straight path.
struct Line {
    static constexpr const char* name = "line";
    Vec2 from_m;
    Vec2 to_m;
    bool operator==(const Line&) const = default;
};

template <class Walk, Is<Line> L>
void walk_fields(Walk& walk, L& line) {
    walk(line.from_m, {.key = "from_mm", .given = Given::required, .meaning = "start"});
    walk(line.to_m, {.key = "to_mm", .given = Given::required, .meaning = "end"});
}

/// An arc from the angle `start_rad` (from x towards y), or a full circle.
struct Arc {
    static constexpr const char* name = "arc";
    Vec2 center_m;
    double radius_m = 0.0;
    double start_rad = 0.0;
    double sweep_rad = 0.0; // at most a full turn; negative: clockwise
    bool operator==(const Arc&) const = default;
};

template <class Walk, Is<Arc> A>
void walk_fields(Walk& walk, A& arc) {
    walk(arc.center_m, {.key = "center_mm", .meaning = "centre"});
    walk(arc.radius_m, {.key = "radius_mm",
                        .range = Range::between(0.0, 1e4),
                        .given = Given::required,
                        .meaning = "radius; at least 0.001, except as the pattern of STP"});
    walk(arc.start_rad,
         {.key = "start_deg", .meaning = "angle of the starting point, from x towards y"});
    walk(arc.sweep_rad, {.key = "sweep_deg",
                         .range = Range::between(-360.0, 360.0),
                         .given = Given::required,
                         .meaning = "angle covered by the arc; negative: clockwise"});
}

enum class Ends { open, closed };
constexpr auto names_of(std::type_identity<Ends>) {
    return std::array{"open", "closed"};
}

/// Straight lines between at least two points; a closed polyline returns to the first. Its corners
/// are turns of 20 degrees or more, so that the points of a sampled curve are not corners.
class Polyline {
public:
    static constexpr const char* name = "polyline";
    Polyline(std::vector<Vec2> points_m, Ends ends);
    bool operator==(const Polyline& other) const {
        return ends_ == other.ends_ && points_m_ == other.points_m_;
    }

    const std::vector<Vec2>& points_m() const { return points_m_; }
    Ends ends() const { return ends_; }
    double length_m() const { return arcs_m_.back(); }
    /// The arc length at a point.
    double arc_m(std::size_t point) const { return arcs_m_[point]; }
    /// Beyond an end, it continues along the last tangent.
    Vec2 at(double arc_m) const;
    Vec2 tangent(double arc_m) const;
    /// The side on which an arc length lies.
    std::size_t piece(double arc_m) const;
    std::span<const double> corners_m() const { return corners_m_; }
    bool starts_at_corner() const { return starts_at_corner_; }

private:
    Vec2 point(std::size_t i) const { return points_m_[i % points_m_.size()]; }
    Vec2 direction(std::size_t piece) const;

    std::vector<Vec2> points_m_;
    Ends ends_;
    std::vector<double> arcs_m_; // at the points; if closed, also at the return to the first
    std::vector<double> corners_m_;
    bool starts_at_corner_ = false;
};

template <>
struct Example<Polyline> {
    static Polyline make() { return Polyline({{}, {1e-2, 0.0}, {1e-2, 1e-2}}, Ends::open); }
};

template <class Walk, Is<Polyline> P>
void walk_fields(Walk& walk, P& polyline) {
    // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): a reading walk assigns to it
    std::vector<Vec2> points_m = polyline.points_m();
    Ends ends = polyline.ends();
    walk(ends, {.key = "closed",
                .text = "ends",
                .given = Given::by_hand,
                .type = "boolean",
                .fallback = "false",
                .meaning = "whether the path returns to its first point"});
    walk(points_m, {.key = "points_mm",
                    .text = "points_{}_m",
                    .given = Given::by_hand,
                    .most_in_text = 100,
                    .fallback = "required",
                    .meaning = "points `[[x, y], ...]`",
                    .least_count = 2});
    if constexpr (!std::is_const_v<P>) polyline = Polyline(std::move(points_m), ends);
}

/// A curve on the skin, parametrised by its arc length.
struct Curve {
    std::variant<Line, Arc, Polyline, Lissajous> shape;

    Curve() = default;
    Curve(Vec2 from_m, Vec2 to_m) : shape(Line{from_m, to_m}) {}
    Curve(Line line) : shape(line) {}
    Curve(Arc arc) : shape(arc) {}
    Curve(Polyline polyline) : shape(std::move(polyline)) {}
    Curve(Lissajous lissajous) : shape(std::move(lissajous)) {}
    bool operator==(const Curve&) const = default;
};

/// The words of jobs for shapes of a path: alternatives of Curve and forms of them.
inline constexpr const char* path_words = "word:line|circle|arc|polygon|lissajous|polyline|csv";

double length_m(const Curve& path);
/// The point and the direction at an arc length; beyond the ends, along the tangent.
Vec2 point_m(const Curve& path, double arc_m);
Vec2 tangent(const Curve& path, double arc_m);
/// The number of the smooth piece at an arc length: of a side of a polyline, 0 for other shapes.
std::ptrdiff_t smooth_piece(const Curve& path, double arc_m);
/// Whether the path ends where it starts.
bool is_closed(const Curve& path);
/// Arc lengths of the corners between its ends, ascending.
std::span<const double> corners_m(const Curve& path);
/// Whether a closed path has a corner where it starts and ends.
bool starts_at_corner(const Curve& path);

/// The path, larger by a factor about its centre.
Curve scaled(const Curve& path, double factor);

/// Corners of a regular polygon, anticlockwise, the first at the angle `start_rad`.
Polyline regular_polygon(Vec2 center_m, double radius_m, int corners, double start_rad);

} // namespace shearwake
