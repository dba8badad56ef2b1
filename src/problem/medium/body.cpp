// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/body.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace shearwake {
namespace {

/// cos and sin of an angle, exact along the axes.
Vec2 direction(double angle_deg) {
    const double turn_deg = std::remainder(angle_deg, 360.0);
    if (turn_deg == 0.0) return {1.0, 0.0};
    if (std::abs(turn_deg) == 90.0) return {0.0, std::copysign(1.0, turn_deg)};
    if (std::abs(turn_deg) == 180.0) return {-1.0, 0.0};
    const double turn_rad = to_radians(turn_deg);
    return {std::cos(turn_rad), std::sin(turn_rad)};
}

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Sub-samples along a side of a cell. With 8, the volume of a sphere is in error by 1 % at a
/// radius of one cell and by 1e-3 at three; a smooth edge at least as wide as a cell requires
/// fewer.
constexpr int sharp_samples = 8, smooth_samples = 4;

double dot(Vec3 a, Vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Extent of a cell along a direction.
double extent(Vec3 direction, Vec3 size) {
    return std::abs(direction.x) * size.x + std::abs(direction.y) * size.y +
           std::abs(direction.z) * size.z;
}

/// Length of the part of a unit vector in the x-y plane.
double lateral_part(Vec3 v) {
    return std::hypot(v.x, v.y);
}

/// The fraction of an interval of the given extent across a face that is on the inner side.
/// `distance_m` is negative inside.
struct Face {
    double edge_m;

    double share(double distance_m, double extent_m) const {
        if (edge_m > 0.0 && edge_m >= extent_m) return smooth_share(2.0 * distance_m / edge_m);
        if (extent_m == 0.0) return distance_m < 0.0 ? 1.0 : distance_m > 0.0 ? 0.0 : 0.5;
        return std::clamp(0.5 - distance_m / extent_m, 0.0, 1.0);
    }
    /// The fraction between two parallel faces, which is exact.
    double share_of_slab(double offset_m, double thickness_m, double extent_m) const {
        return share(offset_m - 0.5 * thickness_m, extent_m) +
               share(-offset_m - 0.5 * thickness_m, extent_m) - 1.0;
    }
    /// 1 up to u = -1, 0 from u = 1, all derivatives 0 there. With 1.5 its slope is a bell.
    static double smooth_share(double u) {
        if (u <= -1.0) return 1.0;
        if (u >= 1.0) return 0.0;
        return 0.5 * std::erfc(1.5 * u / std::sqrt((1.0 - u) * (1.0 + u)));
    }
};

/// A convex shape at the origin: the fraction of a sub-sample, whether a point is inside or outside
/// by `margin_m`, and the extent.
class EllipsoidAt {
public:
    EllipsoidAt(const Ellipsoid& shape, double edge_m)
        : r_(shape.semi_axes_m), axes_(axes_of(shape.orientation)), face_{edge_m} {
        least_ = std::min({r_.x, r_.y, r_.z});
    }
    /// Distance k0 (k0 - 1) / k1 with k0 = |p/r|, k1 = |p/r^2| (Quilez, "Ellipsoid distance"):
    /// exact at the surface together with its gradient.
    double share(Vec3 p, Vec3 size) const {
        const Vec3 own = axes_.to_body(p);
        const Vec3 q{own.x / (r_.x * r_.x), own.y / (r_.y * r_.y), own.z / (r_.z * r_.z)};
        const double k0 = level(own), k1 = norm(q);
        if (k1 == 0.0) return face_.share(-least_, 0.0);
        return face_.share(k0 * (k0 - 1.0) / k1, extent(axes_.to_medium(q), size) / k1);
    }
    bool is_inside(Vec3 p, double margin_m) const {
        return level(axes_.to_body(p)) <= 1.0 - margin_m / least_;
    }
    bool is_outside(Vec3 p, double margin_m) const {
        return level(axes_.to_body(p)) > 1.0 + margin_m / least_;
    }
    /// k0 - 1 is at most the distance divided by the smallest semi-axis, which bounds the extent of
    /// the edge.
    Vec3 reach_m() const {
        const auto reach = [&](double x, double y, double z) {
            return norm({r_.x * x, r_.y * y, r_.z * z});
        };
        return (1.0 + 0.5 * face_.edge_m / least_) * Vec3{reach(axes_.x.x, axes_.y.x, axes_.z.x),
                                                          reach(axes_.x.y, axes_.y.y, axes_.z.y),
                                                          reach(axes_.x.z, axes_.y.z, axes_.z.z)};
    }

private:
    double level(Vec3 own) const { return norm({own.x / r_.x, own.y / r_.y, own.z / r_.z}); }
    Vec3 r_;
    BodyAxes axes_;
    Face face_;
    double least_;
};

/// The axes of a cylinder: x is its axis.
BodyAxes cylinder_axes(const Cylinder& shape) {
    if (shape.axis == CylinderAxis::vertical)
        return {{0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    return axes_of(
        Orientation{.azimuth_deg = shape.azimuth_deg, .inclination_deg = shape.inclination_deg});
}

class CylinderAt {
public:
    CylinderAt(const Cylinder& shape, double edge_m)
        : shape_(shape), endless_(shape.is_endless()), face_{edge_m} {
        const BodyAxes axes = cylinder_axes(shape);
        along_ = axes.x, across_ = axes.y, up_ = axes.z;
    }
    double share(Vec3 p, Vec3 size) const {
        const double v = dot(p, across_), w = dot(p, up_), r = std::hypot(v, w);
        const Vec3 out = r > 0.0 ? (v / r) * across_ + (w / r) * up_ : Vec3{};
        const double round = face_.share(r - shape_.radius_m, extent(out, size));
        if (endless_) return round;
        return round * face_.share_of_slab(dot(p, along_), shape_.length_m, extent(along_, size));
    }
    bool is_inside(Vec3 p, double margin_m) const {
        return std::hypot(dot(p, across_), dot(p, up_)) <= shape_.radius_m - margin_m &&
               (endless_ || std::abs(dot(p, along_)) <= 0.5 * shape_.length_m - margin_m);
    }
    bool is_outside(Vec3 p, double margin_m) const {
        return std::hypot(dot(p, across_), dot(p, up_)) > shape_.radius_m + margin_m ||
               (!endless_ && std::abs(dot(p, along_)) > 0.5 * shape_.length_m + margin_m);
    }
    /// Whether a step along x, y or z changes nothing.
    std::array<bool, 3> is_uniform() const {
        return {endless_ && along_.y == 0.0 && along_.z == 0.0,
                endless_ && along_.x == 0.0 && along_.z == 0.0,
                endless_ && along_.x == 0.0 && along_.y == 0.0};
    }
    Vec3 reach_m() const {
        const double round = shape_.radius_m + 0.5 * face_.edge_m;
        const double half = endless_ ? infinity : 0.5 * (shape_.length_m + face_.edge_m);
        const auto reach = [&](double a, double b, double c) {
            return (a == 0.0 ? 0.0 : std::abs(a) * half) + std::hypot(b, c) * round;
        };
        return {reach(along_.x, across_.x, up_.x), reach(along_.y, across_.y, up_.y),
                reach(along_.z, across_.z, up_.z)};
    }

private:
    Cylinder shape_;
    bool endless_;
    Face face_;
    Vec3 along_, across_, up_; // orthonormal
};

class BoxAt {
public:
    BoxAt(const Box& shape, double edge_m)
        : size_(shape.size_m), axes_(axes_of(shape.orientation)), face_{edge_m} {}
    double share(Vec3 p, Vec3 size) const {
        const Vec3 own = axes_.to_body(p);
        return face_.share_of_slab(own.x, size_.x, extent(axes_.x, size)) *
               face_.share_of_slab(own.y, size_.y, extent(axes_.y, size)) *
               face_.share_of_slab(own.z, size_.z, extent(axes_.z, size));
    }
    bool is_inside(Vec3 p, double margin_m) const {
        const Vec3 own = axes_.to_body(p);
        return std::abs(own.x) <= 0.5 * size_.x - margin_m &&
               std::abs(own.y) <= 0.5 * size_.y - margin_m &&
               std::abs(own.z) <= 0.5 * size_.z - margin_m;
    }
    bool is_outside(Vec3 p, double margin_m) const {
        const Vec3 own = axes_.to_body(p);
        return std::abs(own.x) > 0.5 * size_.x + margin_m ||
               std::abs(own.y) > 0.5 * size_.y + margin_m ||
               std::abs(own.z) > 0.5 * size_.z + margin_m;
    }
    Vec3 reach_m() const {
        const double edge_m = face_.edge_m;
        const Vec3 half = 0.5 * (size_ + Vec3{edge_m, edge_m, edge_m});
        return {extent({axes_.x.x, axes_.y.x, axes_.z.x}, half),
                extent({axes_.x.y, axes_.y.y, axes_.z.y}, half),
                extent({axes_.x.z, axes_.y.z, axes_.z.z}, half)};
    }

private:
    Vec3 size_;
    BodyAxes axes_;
    Face face_;
};

/// Calls f with the shape of the body at the origin.
template <class F>
auto with_shape(const Body& body, F f) {
    return std::visit(
        overloaded{
            [&](const Ellipsoid& shape) { return f(EllipsoidAt(shape, body.edge_m)); },
            [&](const Cylinder& shape) { return f(CylinderAt(shape, body.edge_m)); },
            [&](const Box& shape) { return f(BoxAt(shape, body.edge_m)); },
        },
        body.shape);
}

bool is_beyond(double offset_m, double size_m, double reach_m) {
    return std::abs(offset_m) >= 0.5 * size_m + reach_m;
}

template <class Shape>
bool contains_corners(const Shape& shape, Vec3 offset, Vec3 size, double margin_m) {
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5})
            for (const double z : {-0.5, 0.5})
                if (!shape.is_inside(offset + Vec3{x * size.x, y * size.y, z * size.z}, margin_m))
                    return false;
    return true;
}

template <class Shape>
double sampled_share(const Shape& shape, Vec3 offset, Vec3 size, int samples) {
    std::array<bool, 3> is_uniform{};
    if constexpr (requires { shape.is_uniform(); }) is_uniform = shape.is_uniform();
    const auto count = [&](double length_m, std::size_t axis) {
        return length_m > 0.0 && !is_uniform[axis] ? samples : 1;
    };
    const int nx = count(size.x, 0), ny = count(size.y, 1), nz = count(size.z, 2);
    // Offset from the centre: (2 i + 1 - n) / 2n of the size, exactly symmetric.
    const auto place = [](int i, int n) { return (2.0 * i + 1.0 - n) / (2.0 * n); };
    const Vec3 part{size.x / nx, size.y / ny, size.z / nz};
    double sum = 0.0;
    for (int i = 0; i < nx; ++i)
        for (int j = 0; j < ny; ++j)
            for (int k = 0; k < nz; ++k)
                sum += shape.share(offset + Vec3{place(i, nx) * size.x, place(j, ny) * size.y,
                                                 place(k, nz) * size.z},
                                   part);
    return sum / (nx * ny * nz);
}

/// Smallest width of the section of an ellipsoid with the horizontal plane through its centre.
double lateral_width_m(const Ellipsoid& shape) {
    const BodyAxes f = axes_of(shape.orientation);
    const Vec3 r = shape.semi_axes_m;
    double unit_m = infinity; // the result if the axes are horizontal or vertical
    for (const auto& [axis, r_m] : {std::pair{f.x, r.x}, std::pair{f.y, r.y}, std::pair{f.z, r.z}})
        if (lateral_part(axis) > 0.0) unit_m = std::min(unit_m, r_m);
    // The section is x A x = 1, in this unit.
    double xx = 0.0, yy = 0.0, xy = 0.0;
    for (const auto& [axis, r_m] :
         {std::pair{f.x, r.x}, std::pair{f.y, r.y}, std::pair{f.z, r.z}}) {
        const double weight = (unit_m / r_m) * (unit_m / r_m);
        xx += weight * axis.x * axis.x;
        yy += weight * axis.y * axis.y;
        xy += weight * axis.x * axis.y;
    }
    const double apart = std::abs(xx - yy);
    const double largest = std::max(xx, yy) + 0.5 * (std::hypot(apart, 2.0 * xy) - apart);
    return 2.0 * unit_m / std::sqrt(largest);
}

} // namespace

bool Cylinder::is_endless() const {
    return length_m == 0.0 || std::isinf(length_m);
}

BodyAxes axes_of(const Orientation& orientation) {
    const Vec2 turn = direction(orientation.azimuth_deg),
               tilt = direction(orientation.inclination_deg),
               roll = direction(orientation.roll_deg);
    const Vec3 x{turn.x * tilt.x, turn.y * tilt.x, tilt.y};
    const Vec3 across{-turn.y, turn.x, 0.0};
    const Vec3 down{-turn.x * tilt.y, -turn.y * tilt.y, tilt.x};
    return {x, roll.x * across + roll.y * down, roll.x * down - roll.y * across};
}

BodyAxes axes_of(const Body& body) {
    return std::visit(overloaded{
                          [](const Cylinder& shape) {
                              if (shape.axis == CylinderAxis::vertical) return BodyAxes{};
                              return cylinder_axes(shape);
                          },
                          [](const auto& shape) { return axes_of(shape.orientation); },
                      },
                      body.shape);
}

bool is_turned(const Body& body) {
    return std::visit(overloaded{
                          [](const Cylinder& shape) {
                              return shape.axis == CylinderAxis::horizontal &&
                                     shape.inclination_deg != 0.0;
                          },
                          [](const auto& shape) { return shape.orientation != Orientation{}; },
                      },
                      body.shape);
}

Body aligned(Body body) {
    if (!is_turned(body)) return body;
    std::visit(overloaded{
                   [](Cylinder& shape) { shape.azimuth_deg = shape.inclination_deg = 0.0; },
                   [](auto& shape) { shape.orientation = {}; },
               },
               body.shape);
    return body;
}

double volume_fraction(const Body& body, Vec3 centre_m, Vec3 size_m) {
    const Vec3 offset = centre_m - body.centre_m;
    return with_shape(body, [&](const auto& shape) {
        const Vec3 reach = shape.reach_m();
        if (is_beyond(offset.x, size_m.x, reach.x) || is_beyond(offset.y, size_m.y, reach.y) ||
            is_beyond(offset.z, size_m.z, reach.z))
            return 0.0;
        // Half a diagonal, and half of that of a sub-sample, which is at most a quarter.
        if (shape.is_outside(offset, 0.5 * (1.25 * norm(size_m) + body.edge_m))) return 0.0;
        if (contains_corners(shape, offset, size_m, 0.5 * body.edge_m)) return 1.0;
        const bool is_smooth =
            body.edge_m > 0.0 && body.edge_m >= std::max({size_m.x, size_m.y, size_m.z});
        // Cells wider than the body are those of estimates.
        const bool is_wide = size_m.x > 2.0 * reach.x && size_m.y > 2.0 * reach.y;
        return sampled_share(shape, offset, size_m,
                             is_smooth || is_wide ? smooth_samples : sharp_samples);
    });
}

bool share_a_point(const Body& a, const Body& b, const Bounds& box, int halvings) {
    const auto search = [&](const auto& self, const auto& one, const auto& other, Vec3 centre,
                            Vec3 size, int left) -> bool {
        const Vec3 from_a = centre - a.centre_m, from_b = centre - b.centre_m;
        if (one.is_outside(from_a, 0.5 * (norm(size) + a.edge_m)) ||
            other.is_outside(from_b, 0.5 * (norm(size) + b.edge_m)))
            return false;
        if (one.share(from_a, {}) > 0.0 && other.share(from_b, {}) > 0.0) return true;
        for (int octant = 0; left > 0 && octant < 8; ++octant) {
            const auto side = [&](int bit) { return (octant & bit) != 0 ? 0.25 : -0.25; };
            const Vec3 shift{side(1) * size.x, side(2) * size.y, side(4) * size.z};
            if (self(self, one, other, centre + shift, 0.5 * size, left - 1)) return true;
        }
        return false;
    };
    return with_shape(a, [&](const auto& one) {
        return with_shape(b, [&](const auto& other) {
            return search(search, one, other, 0.5 * (box.low_m + box.high_m),
                          box.high_m - box.low_m, halvings);
        });
    });
}

Bounds bounds(const Body& body) {
    const Vec3 reach = with_shape(body, [](const auto& shape) { return shape.reach_m(); });
    return {body.centre_m - reach, body.centre_m + reach};
}

double thickness_m(const Body& body) {
    const auto least = [](Vec3 v) { return std::min({v.x, v.y, v.z}); };
    return std::visit(overloaded{
                          [&](const Ellipsoid& e) { return 2.0 * least(e.semi_axes_m); },
                          [&](const Cylinder& c) {
                              return std::min(2.0 * c.radius_m,
                                              c.is_endless() ? infinity : c.length_m);
                          },
                          [&](const Box& b) { return least(b.size_m); },
                      },
                      body.shape);
}

double lateral_thickness_m(const Body& body) {
    // A slab is this wide in a horizontal plane.
    const auto slab_m = [](double width_m, Vec3 normal) {
        const double part = lateral_part(normal);
        return part > 0.0 ? width_m / part : infinity;
    };
    return std::visit(overloaded{
                          [](const Ellipsoid& e) { return lateral_width_m(e); },
                          [&](const Cylinder& c) {
                              const double ends_m = c.is_endless()
                                                        ? infinity
                                                        : slab_m(c.length_m, cylinder_axes(c).x);
                              return std::min(2.0 * c.radius_m, ends_m);
                          },
                          [&](const Box& b) {
                              const BodyAxes f = axes_of(b.orientation);
                              return std::min({slab_m(b.size_m.x, f.x), slab_m(b.size_m.y, f.y),
                                               slab_m(b.size_m.z, f.z)});
                          },
                      },
                      body.shape);
}

} // namespace shearwake
