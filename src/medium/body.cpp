// SPDX-License-Identifier: BSD-3-Clause
#include "medium/body.hpp"

#include "base/overloaded.hpp"
#include "base/vec2.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace shearwake {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Sub-samples along a side of a cell. With 8, the volume of a sphere is in error by 1 % at a
/// radius of one cell and by 1e-3 at three; a smooth edge of at least the width of a cell requires
/// fewer.
constexpr int sharp_samples = 8;
constexpr int smooth_samples = 4;

/// cos and sin of the azimuth, exact along the axes.
Vec2 direction(double azimuth_deg) {
    const double turn_deg = std::remainder(azimuth_deg, 360.0);
    if (turn_deg == 0.0) return {1.0, 0.0};
    if (std::abs(turn_deg) == 90.0) return {0.0, std::copysign(1.0, turn_deg)};
    if (std::abs(turn_deg) == 180.0) return {-1.0, 0.0};
    const double turn_rad = turn_deg * std::numbers::pi / 180.0;
    return {std::cos(turn_rad), std::sin(turn_rad)};
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

/// A convex shape at the origin: the fraction of a sub-sample, whether a point is inside by
/// `margin_m`, and the extent.
class EllipsoidAt {
public:
    EllipsoidAt(const Ellipsoid& shape, double edge_m) : r_(shape.semi_axes_m), face_{edge_m} {
        least_ = std::min({r_.x, r_.y, r_.z});
    }
    /// Distance k0 (k0 - 1) / k1 with k0 = |p/r|, k1 = |p/r^2| (Quilez, "Ellipsoid distance"):
    /// exact at the surface together with its gradient.
    double share(Vec3 p, Vec3 size) const {
        const Vec3 q{p.x / (r_.x * r_.x), p.y / (r_.y * r_.y), p.z / (r_.z * r_.z)};
        const double k0 = level(p), k1 = norm(q);
        if (k1 == 0.0) return face_.share(-least_, 0.0);
        const double across =
            (std::abs(q.x) * size.x + std::abs(q.y) * size.y + std::abs(q.z) * size.z) / k1;
        return face_.share(k0 * (k0 - 1.0) / k1, across);
    }
    bool is_inside(Vec3 p, double margin_m) const { return level(p) <= 1.0 - margin_m / least_; }
    /// k0 - 1 is at most the distance divided by the smallest semi-axis, which bounds the extent of
    /// the edge.
    Vec3 reach_m() const { return (1.0 + 0.5 * face_.edge_m / least_) * r_; }

private:
    double level(Vec3 p) const { return norm({p.x / r_.x, p.y / r_.y, p.z / r_.z}); }
    Vec3 r_;
    Face face_;
    double least_;
};

class CylinderAt {
public:
    CylinderAt(const Cylinder& shape, double edge_m)
        : shape_(shape), endless_(shape.is_endless()), face_{edge_m} {
        const Vec2 d = direction(shape.azimuth_deg);
        if (shape.axis == CylinderAxis::horizontal)
            along_ = {d.x, d.y, 0.0}, across_ = {-d.y, d.x, 0.0}, up_ = {0.0, 0.0, 1.0};
        else
            along_ = {0.0, 0.0, 1.0}, across_ = {1.0, 0.0, 0.0}, up_ = {0.0, 1.0, 0.0};
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
    static double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    static double extent(Vec3 n, Vec3 size) {
        return std::abs(n.x) * size.x + std::abs(n.y) * size.y + std::abs(n.z) * size.z;
    }
    Cylinder shape_;
    bool endless_;
    Face face_;
    Vec3 along_, across_, up_; // an orthonormal frame
};

class BoxAt {
public:
    BoxAt(const Box& shape, double edge_m) : size_(shape.size_m), face_{edge_m} {}
    double share(Vec3 p, Vec3 size) const {
        return face_.share_of_slab(p.x, size_.x, size.x) *
               face_.share_of_slab(p.y, size_.y, size.y) *
               face_.share_of_slab(p.z, size_.z, size.z);
    }
    bool is_inside(Vec3 p, double margin_m) const {
        return std::abs(p.x) <= 0.5 * size_.x - margin_m &&
               std::abs(p.y) <= 0.5 * size_.y - margin_m &&
               std::abs(p.z) <= 0.5 * size_.z - margin_m;
    }
    Vec3 reach_m() const {
        const double edge_m = face_.edge_m;
        return 0.5 * (size_ + Vec3{edge_m, edge_m, edge_m});
    }

private:
    Vec3 size_;
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
bool holds_corners(const Shape& shape, Vec3 offset, Vec3 size, double margin_m) {
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5})
            for (const double z : {-0.5, 0.5})
                if (!shape.is_inside(offset + Vec3{x * size.x, y * size.y, z * size.z}, margin_m))
                    return false;
    return true;
}

template <class Shape>
double sampled_share(const Shape& shape, Vec3 offset, Vec3 size, int samples) {
    const auto count = [&](double length_m) { return length_m > 0.0 ? samples : 1; };
    const int nx = count(size.x), ny = count(size.y), nz = count(size.z);
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

} // namespace

bool Cylinder::is_endless() const {
    return length_m == 0.0 || std::isinf(length_m);
}

double volume_fraction(const Body& body, Vec3 centre_m, Vec3 size_m) {
    const Vec3 offset = centre_m - body.centre_m;
    return with_shape(body, [&](const auto& shape) {
        const Vec3 reach = shape.reach_m();
        if (is_beyond(offset.x, size_m.x, reach.x) || is_beyond(offset.y, size_m.y, reach.y) ||
            is_beyond(offset.z, size_m.z, reach.z))
            return 0.0;
        if (holds_corners(shape, offset, size_m, 0.5 * body.edge_m)) return 1.0;
        const bool is_smooth =
            body.edge_m > 0.0 && body.edge_m >= std::max({size_m.x, size_m.y, size_m.z});
        return sampled_share(shape, offset, size_m, is_smooth ? smooth_samples : sharp_samples);
    });
}

Bounds bounds(const Body& body) {
    const Vec3 reach = with_shape(body, [](const auto& shape) { return shape.reach_m(); });
    return {body.centre_m - reach, body.centre_m + reach};
}

double thickness_m(const Body& body) {
    const double height_m = std::visit(overloaded{
                                           [](const Ellipsoid& e) { return 2.0 * e.semi_axes_m.z; },
                                           [](const Cylinder& c) {
                                               if (c.axis == CylinderAxis::horizontal)
                                                   return 2.0 * c.radius_m;
                                               return c.is_endless() ? infinity : c.length_m;
                                           },
                                           [](const Box& b) { return b.size_m.z; },
                                       },
                                       body.shape);
    return std::min(height_m, lateral_thickness_m(body));
}

double lateral_thickness_m(const Body& body) {
    return std::visit(
        overloaded{
            [](const Ellipsoid& e) { return 2.0 * std::min(e.semi_axes_m.x, e.semi_axes_m.y); },
            [](const Cylinder& c) {
                const bool has_end = c.axis == CylinderAxis::horizontal && !c.is_endless();
                return std::min(2.0 * c.radius_m, has_end ? c.length_m : infinity);
            },
            [](const Box& b) { return std::min(b.size_m.x, b.size_m.y); },
        },
        body.shape);
}

} // namespace shearwake
