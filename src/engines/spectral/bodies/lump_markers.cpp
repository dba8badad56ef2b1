// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/lump_markers.hpp"

#include "base/field.hpp"
#include "base/units.hpp"
#include "engines/spectral/bodies/rigid_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace shearwake::spectral {
namespace {

/// Distance of the rings of an ellipsoid along a meridian, in spacings. With marker_spacing, rings
/// near a pole overlap, and their horizontal forces alternate by up to a quarter of the largest one
/// (a sphere of 6 spacings per radius): its force is in error by 1.3 % instead of 0.7 %.
constexpr double ring_spacing = 1.4;
constexpr int steps_of_quarter = 2000;

/// Part of a unit vector in the lateral directions, in which forces are smoothed.
double lateral_part(Vec3 v) {
    return std::hypot(v.x, v.y);
}

/// Spacings of the grid and of the levels.
struct Spacings {
    double across_m, down_m;

    double along(Vec3 direction) const {
        if (direction.z == 0.0) return across_m;
        const double lateral = lateral_part(direction);
        return lateral == 0.0 ? down_m : 1.0 / std::hypot(lateral / across_m, direction.z / down_m);
    }
};

/// Adds the points of a horizontal ellipse.
void add_ellipse(double a_m, double b_m, double z_m, double spacing_m, std::vector<Vec3>& points) {
    if (std::min(a_m, b_m) < 0.35 * spacing_m && std::max(a_m, b_m) < 0.5 * spacing_m)
        return points.push_back({0.0, 0.0, z_m});
    for (const double angle : quarter_angles(a_m, b_m, spacing_m, steps_of_quarter)) {
        const double x = a_m * std::sin(angle), y = b_m * std::cos(angle);
        for (const double sign_x : {1.0, -1.0})
            for (const double sign_y : {1.0, -1.0})
                points.push_back({sign_x * x, sign_y * y, z_m});
    }
}

/// Adds ellipses inside one.
void fill_ellipse(double a_m, double b_m, double z_m, double spacing_m, std::vector<Vec3>& points) {
    for (a_m -= spacing_m, b_m -= spacing_m; a_m > 0.3 * spacing_m && b_m > 0.3 * spacing_m;
         a_m -= spacing_m, b_m -= spacing_m)
        add_ellipse(a_m, b_m, z_m, spacing_m, points);
    // The centre, if no ellipse is close to it.
    if (std::min(a_m, b_m) > -0.5 * spacing_m) points.push_back({0.0, 0.0, z_m});
}

/// Rings about the z axis of the body, as far apart as the points on them. They have a constant
/// depth if this axis is vertical.
std::vector<Vec3> on_ellipsoid(Vec3 r, const BodyAxes& axes, const Spacings& h) {
    const double across_m = std::min(h.along(axes.x), h.along(axes.y));
    const double down_m = h.along(axes.z), between_m = inner_spacing * across_m;
    const bool is_upright = std::abs(axes.z.z) == 1.0;
    double last_inside_m = r.z;
    std::vector<Vec3> points;
    for (const double angle : quarter_angles(std::sqrt(r.x * r.y) / across_m, r.z / down_m,
                                             ring_spacing, steps_of_quarter)) {
        const double s = std::sin(angle), c = std::cos(angle); // from the pole
        std::vector<Vec3> ring;
        add_ellipse(r.x * s, r.y * s, r.z * c, marker_spacing * across_m, ring);
        double depth_m = 0.0;
        for (Vec3& p : ring) {
            Vec3 normal{p.x / (r.x * r.x), p.y / (r.y * r.y), p.z / (r.z * r.z)};
            normal = (1.0 / norm(normal)) * normal;
            const double smoothed = lateral_part(axes.to_medium(normal));
            p = p - (curved_inset * h.across_m * smoothed) * normal;
            depth_m += p.z / static_cast<double>(ring.size());
        }
        const std::size_t surface = ring.size();
        if (last_inside_m - depth_m > 2.0 * down_m) {
            fill_ellipse(r.x * s, r.y * s, depth_m, between_m, ring);
            if (ring.size() > surface) last_inside_m = depth_m;
        }
        for (std::size_t i = 0; i < surface && is_upright; ++i)
            ring[i].z = depth_m;
        points.insert(points.end(), ring.begin(), ring.end());
    }
    const std::size_t half = points.size();
    for (std::size_t i = 0; i < half; ++i)
        points.push_back(-1.0 * points[i]);
    return points;
}

/// Positions along a line, symmetric about its middle: with the surface of the body at both ends,
/// or around the periodic domain.
struct Line {
    std::vector<double> at;
    bool has_ends;

    std::size_t size() const { return at.size(); }
    bool is_end(std::size_t index) const {
        return has_ends && (index == 0 || index + 1 == at.size());
    }
    /// Whether an inner point may be kept at this index: every second one.
    bool is_second(std::size_t index) const {
        return std::min(index, at.size() - 1 - index) % 2 == 0;
    }
};

/// Points from -half to half, about `spacing` apart.
Line along_line(double half, double spacing) {
    const auto parts = std::max(1L, std::lround(2.0 * half / spacing));
    Line line{{}, true};
    for (long i = 0; i <= parts; ++i)
        line.at.push_back(half * (2.0 * static_cast<double>(i) / static_cast<double>(parts) - 1.0));
    return line;
}

/// Points at equal distances around a period.
Line around_domain(double extent, double spacing) {
    const auto parts = std::max(1L, std::lround(extent / spacing));
    Line line{{}, false};
    for (long i = 0; i < parts; ++i)
        line.at.push_back(extent *
                          ((static_cast<double>(i) + 0.5) / static_cast<double>(parts) - 0.5));
    return line;
}

/// Points from end to end along an axis of the body that ends at flat faces.
Line between_faces(double length_m, Vec3 axis, const Spacings& h) {
    return along_line(0.5 * length_m - flat_inset * h.across_m * lateral_part(axis),
                      marker_spacing * h.along(axis));
}

std::vector<Vec3> on_box(Vec3 size_m, Endless along, const BodyAxes& axes, const Spacings& h) {
    const auto line = [&](double length_m, Vec3 axis, Endless endless) {
        return along == endless ? around_domain(length_m, marker_spacing * h.across_m)
                                : between_faces(length_m, axis, h);
    };
    const Line x = line(size_m.x, axes.x, Endless::along_x),
               y = line(size_m.y, axes.y, Endless::along_y), z = between_faces(size_m.z, axes.z, h);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < x.size(); ++i)
        for (std::size_t j = 0; j < y.size(); ++j)
            for (std::size_t k = 0; k < z.size(); ++k)
                if (x.is_end(i) || y.is_end(j) || z.is_end(k) ||
                    (x.is_second(i) && y.is_second(j) && z.is_second(k)))
                    points.push_back({x.at[i], y.at[j], z.at[k]});
    return points;
}

/// A cylinder along the third axis.
std::vector<Vec3> on_upright(double radius_m, double length_m, const BodyAxes& axes,
                             const Spacings& h) {
    const double inset_m = curved_inset * h.across_m, apart_m = marker_spacing * h.across_m;
    const double x_m = radius_m - inset_m * lateral_part(axes.x),
                 y_m = radius_m - inset_m * lateral_part(axes.y);
    const Line z = between_faces(length_m, axes.z, h);
    std::vector<Vec3> points;
    for (std::size_t k = 0; k < z.size(); ++k) {
        add_ellipse(x_m, y_m, z.at[k], apart_m, points);
        if (z.is_end(k) || z.is_second(k))
            fill_ellipse(x_m, y_m, z.at[k], z.is_end(k) ? apart_m : inner_spacing * h.across_m,
                         points);
    }
    return points;
}

/// Along the first axis.
std::vector<Vec3> on_inclined(const Cylinder& shape, const BodyAxes& axes, const Spacings& h) {
    std::vector<Vec3> points =
        on_upright(shape.radius_m, shape.length_m, {axes.y, axes.z, axes.x}, h);
    for (Vec3& p : points)
        p = {p.z, p.x, p.y};
    return points;
}

/// The cross-section at equal distances along the axis, and both ends filled if there are any.
std::vector<Vec3> on_lying(const Cylinder& shape, Endless along, const Spacings& h) {
    const std::vector<SectionMarker> section = section_markers(
        {.name = {}, .shape = shape, .centre_m = {}}, Endless::along_x, h.across_m, h.down_m);
    const double apart_m = marker_spacing * h.across_m;
    const Line axis = along == Endless::no
                          ? along_line(0.5 * shape.length_m - flat_inset * h.across_m, apart_m)
                          : around_domain(shape.length_m, apart_m);
    const double turn = to_radians(shape.azimuth_deg);
    std::vector<Vec3> points;
    const auto add = [&](double on_axis, double across, double down) {
        points.push_back({on_axis * std::cos(turn) - across * std::sin(turn),
                          on_axis * std::sin(turn) + across * std::cos(turn), down});
    };
    double last_filled_m = -std::numeric_limits<double>::infinity();
    for (std::size_t begin = 0, end; begin < section.size(); begin = end) {
        for (end = begin; end < section.size() && section[end].down_m == section[begin].down_m;)
            ++end;
        const double half_m = std::abs(section[begin].across_m), down_m = section[begin].down_m;
        const bool fills = down_m - last_filled_m > 0.8 * h.down_m;
        if (fills) last_filled_m = down_m;
        for (std::size_t i = 0; i < axis.size(); ++i) {
            if (fills && axis.is_end(i)) {
                const Line across = along_line(half_m, apart_m);
                for (std::size_t j = 1; j + 1 < across.size(); ++j)
                    add(axis.at[i], across.at[j], down_m);
            }
            for (std::size_t j = begin; j < end; ++j) {
                const double across_m = section[j].across_m;
                const bool inside = std::abs(across_m) < 0.999 * half_m;
                if (inside && (axis.is_end(i) || !axis.is_second(i))) continue;
                add(axis.at[i], across_m, down_m);
            }
        }
    }
    return points;
}

/// lump_mass() from cells whose mass is at their centre, `samples` along each side of the bounds
/// of the body without its orientation.
std::vector<double> sampled_mass(const Body& body, const Body& lump, const Medium& medium,
                                 int samples) {
    const bool turned = is_turned(lump);
    const Body straight = aligned(lump);
    const BodyAxes axes = axes_of(lump);
    const Bounds box = bounds(straight);
    const Vec3 cell = (1.0 / samples) * (box.high_m - box.low_m);
    std::vector<double> mass(lump_freedoms * lump_freedoms, 0.0);
    for (int i = 0; i < samples; ++i)
        for (int j = 0; j < samples; ++j)
            for (int k = 0; k < samples; ++k) {
                const Vec3 cell_m =
                    box.low_m + Vec3{(i + 0.5) * cell.x, (j + 0.5) * cell.y, (k + 0.5) * cell.z};
                const Vec3 at =
                    turned ? lump.centre_m + axes.to_medium(cell_m - lump.centre_m) : cell_m;
                const double around = density_at(medium, at.z);
                const double more = (body.density_kg_m3.value_or(around) - around) * cell.x *
                                    cell.y * cell.z * volume_fraction(straight, cell_m, cell);
                const auto moves = motions_at(at - body.centre_m);
                for (std::size_t a = 0; a < lump_freedoms; ++a)
                    for (std::size_t b = 0; b < lump_freedoms; ++b)
                        mass[a * lump_freedoms + b] +=
                            more * (moves[a].x * moves[b].x + moves[a].y * moves[b].y +
                                    moves[a].z * moves[b].z);
            }
    return mass;
}

constexpr double same_depth = 0.3, same_point = 0.4;

/// Moves points at almost the same depth to one.
void join_depths(double within_m, std::vector<Vec3>& points) {
    std::ranges::sort(points, {}, [](Vec3 p) { return std::tuple(p.z, p.x, p.y); });
    for (std::size_t begin = 0, end; begin < points.size(); begin = end) {
        for (end = begin; end < points.size() && points[end].z <= points[begin].z + within_m;)
            ++end;
        const double depth_m = 0.5 * (points[begin].z + points[end - 1].z);
        for (std::size_t i = begin; i < end; ++i)
            points[i].z = depth_m;
    }
}

/// Replaces points that are too close to each other, as at the rim of a flat body, by their mean,
/// which preserves the symmetry.
void join_points(double across_m, double down_m, std::vector<Vec3>& points) {
    std::vector<std::size_t> group(points.size());
    std::iota(group.begin(), group.end(), std::size_t{0});
    const auto first_of = [&](std::size_t i) {
        while (group[i] != i)
            i = group[i];
        return i;
    };
    std::vector<std::size_t> order = group; // by x: fewer are close in x than in depth
    std::ranges::sort(order, {}, [&](std::size_t i) { return points[i].x; });
    for (std::size_t m = 0; m < order.size(); ++m)
        for (std::size_t n = m + 1; n < order.size(); ++n) {
            const std::size_t i = order[m], j = order[n];
            const Vec3 apart = points[j] - points[i];
            if (apart.x >= same_point * across_m) break;
            if (norm({apart.x / across_m, apart.y / across_m, apart.z / down_m}) < same_point) {
                const std::size_t a = first_of(i), b = first_of(j);
                group[std::max(a, b)] = std::min(a, b);
            }
        }
    std::vector<Vec3> sums(points.size());
    std::vector<double> counts(points.size(), 0.0);
    for (std::size_t i = 0; i < points.size(); ++i) {
        sums[first_of(i)] = sums[first_of(i)] + points[i];
        counts[first_of(i)] += 1.0;
    }
    points.clear();
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (counts[i] > 0.0)
            points.push_back(counts[i] > 1.0 ? (1.0 / counts[i]) * sums[i] : sums[i]);
}

/// Cuts an endless cylinder off at the edges of the domain.
void cut_axis(const Domain& domain, Vec3& centre_m, Cylinder& cylinder) {
    const double turn = to_radians(cylinder.azimuth_deg);
    const double c = std::cos(turn), s = std::sin(turn);
    double from = -std::numeric_limits<double>::infinity(), to = -from;
    const auto cut = [&](double at_m, double slope, double half_m) {
        if (std::abs(slope) < 1e-9) return;
        const double one = (-half_m - at_m) / slope, other = (half_m - at_m) / slope;
        from = std::max(from, std::min(one, other));
        to = std::min(to, std::max(one, other));
    };
    cut(centre_m.x, c, 0.5 * domain.extent_x_m());
    cut(centre_m.y, s, 0.5 * domain.extent_y_m());
    cylinder.length_m = std::max(0.0, to - from);
    centre_m = centre_m + 0.5 * (from + to) * Vec3{c, s, 0.0};
}

} // namespace

Body lump_in(const Body& body, const Domain& domain) {
    Body part = body;
    const Endless along = endless_along(body, domain);
    const auto cut_box = [&](Box& box) {
        if (along == Endless::along_x) part.centre_m.x = 0.0, box.size_m.x = domain.extent_x_m();
        if (along == Endless::along_y) part.centre_m.y = 0.0, box.size_m.y = domain.extent_y_m();
    };
    const auto cut_cylinder = [&](Cylinder& cylinder) {
        if (cylinder.is_endless() && cylinder.axis != CylinderAxis::vertical)
            cut_axis(domain, part.centre_m, cylinder);
    };
    std::visit(overloaded{[](Ellipsoid&) {}, cut_cylinder, cut_box}, part.shape);
    return part;
}

std::vector<Vec3> lump_markers(const Body& body, const Domain& domain, double spacing_z_m) {
    const Spacings h{domain.spacing_m, spacing_z_m};
    const Body lump = lump_in(body, domain);
    const Endless along = endless_along(body, domain);
    const bool turned = is_turned(lump);
    const BodyAxes axes = axes_of(lump);
    std::vector<Vec3> points = std::visit(
        overloaded{
            [&](const Ellipsoid& shape) { return on_ellipsoid(shape.semi_axes_m, axes, h); },
            [&](const Cylinder& shape) {
                if (turned) return on_inclined(shape, axes, h);
                return shape.axis == CylinderAxis::vertical
                           ? on_upright(shape.radius_m, shape.length_m, {}, h)
                           : on_lying(shape, along, h);
            },
            [&](const Box& shape) { return on_box(shape.size_m, along, axes, h); },
        },
        lump.shape);
    for (Vec3& p : points)
        p = (turned ? axes.to_medium(p) : p) + (lump.centre_m - body.centre_m);
    join_close_points(h.across_m, h.down_m, points);
    return points;
}

std::array<Vec3, lump_freedoms> motions_at(Vec3 offset_m) {
    std::array<Vec3, lump_freedoms> all;
    for (std::size_t f = 0; f < lump_freedoms; ++f) {
        const Vec3 axis{f % 3 == 0 ? 1.0 : 0.0, f % 3 == 1 ? 1.0 : 0.0, f % 3 == 2 ? 1.0 : 0.0};
        all[f] = (f < 3 ? RigidMotion{axis, {}} : RigidMotion{{}, axis}).at(offset_m);
    }
    return all;
}

std::vector<double> lump_mass(const Body& body, const Domain& domain, const Medium& medium) {
    const Body lump = lump_in(body, domain);
    const std::vector<double> coarse = sampled_mass(body, lump, medium, 12);
    std::vector<double> mass = sampled_mass(body, lump, medium, 24);
    for (std::size_t i = 0; i < mass.size(); ++i) // the error decreases with the square of the cell
        mass[i] += (mass[i] - coarse[i]) / 3.0;
    return mass;
}

void join_close_points(double across_m, double down_m, std::vector<Vec3>& points) {
    join_depths(same_depth * down_m, points);
    join_points(across_m, down_m, points);
}

} // namespace shearwake::spectral
