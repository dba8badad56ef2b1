#pragma once

#include "base/vec2.hpp"
#include "model/lissajous.hpp"

#include <span>
#include <variant>
#include <vector>

namespace shearwake {

/// A straight path.
struct Line {
    Vec2 from_m;
    Vec2 to_m;
    bool operator==(const Line&) const = default;
};

/// Part of a circle from the angle `start_rad` on (from x towards y), or the whole of it.
struct Arc {
    Vec2 center_m;
    double radius_m = 0.0;
    double start_rad = 0.0;
    double sweep_rad = 0.0; // at most a whole turn; negative: clockwise
    bool operator==(const Arc&) const = default;
};

enum class Ends { open, closed };

/// Straight from point to point, at least two; a closed one returns to the first. Its corners are
/// where it turns by 20 degrees or more: the points of a curve are none.
class Polyline {
public:
    Polyline(std::vector<Vec2> points_m, Ends ends);
    bool operator==(const Polyline& other) const {
        return ends_ == other.ends_ && points_m_ == other.points_m_;
    }

    const std::vector<Vec2>& points_m() const { return points_m_; }
    Ends ends() const { return ends_; }
    double length_m() const { return arcs_m_.back(); }
    /// Beyond an end it goes on along the last tangent.
    Vec2 at(double arc_m) const;
    Vec2 tangent(double arc_m) const;
    std::span<const double> corners_m() const { return corners_m_; }
    bool starts_at_corner() const { return starts_at_corner_; }

private:
    Vec2 point(std::size_t i) const { return points_m_[i % points_m_.size()]; }
    std::size_t piece(double arc_m) const;
    Vec2 direction(std::size_t piece) const;

    std::vector<Vec2> points_m_;
    Ends ends_;
    std::vector<double> arcs_m_; // of the points; closed: and of the first one again
    std::vector<double> corners_m_;
    bool starts_at_corner_ = false;
};

/// A curve on the skin, run along by its arc length.
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

double length_m(const Curve& path);
/// The point and the direction after that much of the path; beyond its ends on along the tangent.
Vec2 point_m(const Curve& path, double arc_m);
Vec2 tangent(const Curve& path, double arc_m);
/// Whether it ends where it starts.
bool is_closed(const Curve& path);
/// Arc lengths of the corners between its ends, ascending.
std::span<const double> corners_m(const Curve& path);
/// Whether a closed path has a corner where it starts and ends.
bool starts_at_corner(const Curve& path);

/// Corners of a regular polygon, anticlockwise, the first at the angle `start_rad`.
Polyline regular_polygon(Vec2 center_m, double radius_m, int corners, double start_rad);

} // namespace shearwake
