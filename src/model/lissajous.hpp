#pragma once

#include "base/vec2.hpp"

#include <vector>

namespace shearwake {

/// x = x0 + a sin(p theta + phase), y = y0 + b sin(q theta), theta from 0 to 2 pi.
struct LissajousShape {
    Vec2 center_m;
    Vec2 amplitudes_m; // a, b
    int p = 1;
    int q = 1;
    double phase_rad = 0.0;
    bool operator==(const LissajousShape&) const = default;
};

/// The closed curve by its arc length, which no formula gives: integrated by Gauss' rule between
/// the turning points of x and y and in halves until it is exact to rounding, inverted by Newton's
/// method.
class Lissajous {
public:
    explicit Lissajous(const LissajousShape& shape);
    bool operator==(const Lissajous& other) const { return shape_ == other.shape_; }

    const LissajousShape& shape() const { return shape_; }
    double length_m() const { return arcs_m_.back(); }
    Vec2 at(double arc_m) const;
    Vec2 tangent(double arc_m) const;

private:
    Vec2 slope(double theta_rad) const; // d/d theta
    double piece_m(double from_rad, double to_rad) const;
    void add_pieces(double from_rad, double to_rad, double whole_m, int depth);
    double theta_rad(double arc_m) const;

    LissajousShape shape_;
    std::vector<double> thetas_rad_, arcs_m_; // ends of the pieces
};

} // namespace shearwake
