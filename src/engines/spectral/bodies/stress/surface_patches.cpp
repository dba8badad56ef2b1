// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/stress/surface_patches.hpp"

#include "base/field.hpp"
#include "base/units.hpp"
#include "engines/spectral/bodies/lump_markers.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace shearwake::spectral {

namespace {

double dot(Vec3 a, Vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The patch of a marker at an offset from the centre: the indices of its points and their weights.
std::vector<std::pair<std::size_t, double>> patch_of(Vec3 marker_m,
                                                     const std::vector<SurfacePoint>& surface,
                                                     const std::vector<Vec3>& markers_surface_m,
                                                     double spacing_m, double ring) {
    std::vector<std::pair<std::size_t, double>> patch;
    double least_m = std::numeric_limits<double>::infinity();
    Vec3 normal;
    for (const SurfacePoint& p : surface)
        if (const double distance_m = norm(p.offset_m - marker_m); distance_m < least_m) {
            least_m = distance_m;
            normal = p.normal;
        }
    if (least_m > spacing_m) return patch; // inside
    double sum = 0.0;
    for (std::size_t i = 0; i < surface.size(); ++i) {
        const double x =
            std::pow(norm(markers_surface_m[i] - marker_m) / (patch_radius * spacing_m), 2);
        if (x >= 1.0 || dot(surface[i].normal, normal) < -0.1) continue;
        const double weight = std::pow(1.0 - x, 2) * (1.0 - ring * x);
        patch.push_back({i, weight * surface[i].area_m2});
        sum += patch.back().second;
    }
    for (auto& [point, weight] : patch)
        weight /= sum;
    return patch;
}

} // namespace

SurfacePatches surface_patches(const std::vector<PatchedBody>& bodies,
                               const std::vector<PatchedMarker>& markers, double spacing_m,
                               double ring) {
    SurfacePatches all;
    for (std::size_t body = 0; body < bodies.size(); ++body) {
        const auto& [centre_m, surface, inset] = bodies[body];
        const std::size_t first = all.points.size();
        std::vector<Vec3> markers_surface_m;
        for (const SurfacePoint& p : surface) {
            const Vec3 inwards_m =
                (-inset * spacing_m * std::hypot(p.normal.x, p.normal.y)) * p.normal;
            markers_surface_m.push_back(p.offset_m + inwards_m);
            all.points.push_back({centre_m + p.offset_m + patch_inset * inwards_m, {}});
            all.faces.push_back({centre_m + p.offset_m, p.normal});
        }
        for (std::size_t m = 0; m < markers.size(); ++m) {
            if (markers[m].body != body) continue;
            const auto patch =
                patch_of(markers[m].offset_m, surface, markers_surface_m, spacing_m, ring);
            for (const auto& [point, weight] : patch)
                all.points[first + point].shares.push_back({m, weight});
            if (patch.empty()) all.points.push_back({centre_m + markers[m].offset_m, {{m, 1.0}}});
        }
    }
    std::erase_if(all.points, [](const SurfacePatches::Point& p) { return p.shares.empty(); });
    return all;
}

namespace {

long parts_of(double length_m, double spacing_m) {
    return std::max(1L, std::lround(std::ceil(length_m / spacing_m)));
}

/// Midpoint of part `i` of a length around 0.
double middle(long i, long parts, double length) {
    return length * ((static_cast<double>(i) + 0.5) / static_cast<double>(parts) - 0.5);
}

std::vector<SurfacePoint> on_ellipsoid(Vec3 r, double spacing_m) {
    std::vector<SurfacePoint> points;
    const double wide_m = std::max(r.x, r.y);
    const long rings = parts_of(std::numbers::pi * std::max(wide_m, r.z), spacing_m);
    const double step = std::numbers::pi / static_cast<double>(rings);
    for (long i = 0; i < rings; ++i) {
        const double polar = (static_cast<double>(i) + 0.5) * step;
        const double s = std::sin(polar), c = std::cos(polar);
        const long around = std::max(6L, parts_of(two_pi * wide_m * s, spacing_m));
        for (long j = 0; j < around; ++j) {
            const double angle = two_pi *
                                 (static_cast<double>(j) + 0.5 * static_cast<double>(i % 2)) /
                                 static_cast<double>(around);
            const Vec3 unit{s * std::cos(angle), s * std::sin(angle), c};
            const Vec3 normal{unit.x / r.x, unit.y / r.y, unit.z / r.z};
            // The exact area of the part of the unit sphere, times that of the map to the
            // ellipsoid.
            const double of_sphere =
                2.0 * std::sin(0.5 * step) * s * two_pi / static_cast<double>(around);
            points.push_back({{r.x * unit.x, r.y * unit.y, r.z * unit.z},
                              (1.0 / norm(normal)) * normal,
                              of_sphere * r.x * r.y * r.z * norm(normal)});
        }
    }
    return points;
}

std::vector<SurfacePoint> on_box(Vec3 size_m, Endless along, double spacing_m) {
    std::vector<SurfacePoint> points;
    const double size[3] = {size_m.x, size_m.y, size_m.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if ((axis == 0 && along == Endless::along_x) || (axis == 1 && along == Endless::along_y))
            continue;
        const std::size_t one = (axis + 1) % 3, other = (axis + 2) % 3;
        const long m = parts_of(size[one], spacing_m), n = parts_of(size[other], spacing_m);
        for (long i = 0; i < m; ++i)
            for (long j = 0; j < n; ++j)
                for (const double side : {-1.0, 1.0}) {
                    double at[3] = {}, normal[3] = {};
                    at[axis] = 0.5 * side * size[axis];
                    at[one] = middle(i, m, size[one]);
                    at[other] = middle(j, n, size[other]);
                    normal[axis] = side;
                    points.push_back({{at[0], at[1], at[2]},
                                      {normal[0], normal[1], normal[2]},
                                      size[one] * size[other] / static_cast<double>(m * n)});
                }
    }
    return points;
}

std::vector<SurfacePoint> on_cylinder(const Cylinder& shape, bool has_ends, double spacing_m) {
    std::vector<SurfacePoint> points;
    const double turn = to_radians(shape.azimuth_deg);
    const bool upright = shape.axis == CylinderAxis::vertical;
    const Vec3 axis = upright ? Vec3{0.0, 0.0, 1.0} : Vec3{std::cos(turn), std::sin(turn), 0.0};
    const Vec3 side = upright ? Vec3{1.0, 0.0, 0.0} : Vec3{-std::sin(turn), std::cos(turn), 0.0};
    const Vec3 up = upright ? Vec3{0.0, 1.0, 0.0} : Vec3{0.0, 0.0, 1.0};
    const long along = parts_of(shape.length_m, spacing_m);
    const double cell_m = shape.length_m / static_cast<double>(along);
    /// The points at a radius and a place on the axis.
    const auto ring = [&](double radius_m, double at_m, double width_m, double out) {
        const long around = std::max(6L, parts_of(two_pi * radius_m, spacing_m));
        for (long j = 0; j < around; ++j) {
            const double angle =
                two_pi * (static_cast<double>(j) + 0.5) / static_cast<double>(around);
            const Vec3 radial = std::cos(angle) * side + std::sin(angle) * up;
            points.push_back({at_m * axis + radius_m * radial, out == 0.0 ? radial : out * axis,
                              width_m * two_pi * radius_m / static_cast<double>(around)});
        }
    };
    for (long i = 0; i < along; ++i)
        ring(shape.radius_m, middle(i, along, shape.length_m), cell_m, 0.0);
    const long rings = parts_of(shape.radius_m, spacing_m);
    const double width_m = shape.radius_m / static_cast<double>(rings);
    for (long i = 0; i < rings && has_ends; ++i)
        for (const double out : {-1.0, 1.0})
            ring((static_cast<double>(i) + 0.5) * width_m, 0.5 * out * shape.length_m, width_m,
                 out);
    return points;
}

} // namespace

std::vector<SurfacePoint> surface_points(const Body& body, const Domain& domain, double spacing_m) {
    const Body lump = lump_in(body, domain);
    const Endless along = endless_along(body, domain);
    std::vector<SurfacePoint> points = std::visit(
        overloaded{
            [&](const Ellipsoid& shape) { return on_ellipsoid(shape.semi_axes_m, spacing_m); },
            [&](const Box& shape) { return on_box(shape.size_m, along, spacing_m); },
            [&](const Cylinder& shape) {
                const auto& given = std::get<Cylinder>(body.shape);
                return on_cylinder(shape, !given.is_endless(), spacing_m);
            },
        },
        aligned(lump).shape);
    const bool turned = is_turned(lump);
    const BodyAxes axes = axes_of(lump);
    for (SurfacePoint& p : points) {
        if (turned) p = {axes.to_medium(p.offset_m), axes.to_medium(p.normal), p.area_m2};
        p.offset_m = p.offset_m + (lump.centre_m - body.centre_m);
    }
    return points;
}

} // namespace shearwake::spectral
