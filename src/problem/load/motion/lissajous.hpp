// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"

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

/// The closed curve as a function of its arc length, which has no closed form: it is integrated by
/// Gauss quadrature between the turning points of x and y with bisection until it is exact to
/// rounding, and inverted by Newton's method.
class Lissajous {
public:
    static constexpr const char* name = "lissajous";
    explicit Lissajous(const LissajousShape& shape);
    bool operator==(const Lissajous& other) const { return shape_ == other.shape_; }

    const LissajousShape& shape() const { return shape_; }
    double length_m() const { return arcs_m_.back(); }
    Vec2 at(double arc_m) const;
    Vec2 tangent(double arc_m) const;

private:
    Vec2 slope(double theta_rad) const; // d/d theta
    double piece_m(double from_rad, double to_rad) const;
    void add_pieces(double from_rad, double to_rad, double total_m, int depth);
    double theta_rad(double arc_m) const;

    LissajousShape shape_;
    std::vector<double> thetas_rad_, arcs_m_; // at the ends of the pieces
};

template <>
struct Example<Lissajous> {
    static Lissajous make() {
        static const Lissajous eight({.amplitudes_m = {1e-2, 1e-2}, .p = 1, .q = 2});
        return eight; // its length takes as long as reading a case
    }
};

template <class Walk, Is<Lissajous> Shape>
void walk_fields(Walk& walk, Shape& curve) {
    LissajousShape shape = curve.shape();
    walk(shape.center_m, {.key = "center_mm", .meaning = "centre of the figure"});
    walk(shape.amplitudes_m, {.key = "amplitudes_mm",
                              .range = Range::between(1e-3, 1e4),
                              .given = Given::required,
                              .meaning = "`[a, b]` in x = a sin(p s + phase), y = b sin(q s)"});
    walk.key({.key = "frequencies",
              .range = Range::between(1, 50),
              .given = Given::required,
              .type = "point",
              .meaning = "whole numbers `[p, q]` without a common factor"});
    walk(shape.p, {.text = "p"});
    walk(shape.q, {.text = "q"});
    walk(shape.phase_rad, {.key = "phase_deg", .meaning = "phase of x"});
    if constexpr (!std::is_const_v<Shape>) curve = Lissajous(shape);
}

} // namespace shearwake
