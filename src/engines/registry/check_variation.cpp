// SPDX-License-Identifier: BSD-3-Clause
#include "engines/registry/check.hpp"

#include "base/units.hpp"
#include "problem/medium/material_field.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string>

namespace shearwake {
namespace {

/// "medium.body[2].key"
std::string body_key(std::size_t i, std::string_view key) {
    return fmt::format("medium.body[{}].{}", i + 1, key);
}

void check_resolution(const Case& c, std::size_t i, std::vector<Remark>& remarks) {
    const double width_m = lateral_thickness_m(c.scene.medium.bodies[i]), h_m = c.domain.spacing_m;
    if (width_m < 2.0 * h_m)
        remarks.push_back(
            {Severity::warning, body_key(i, "shape"),
             fmt::format("it is {:.3g} mm wide along the surface and the spacing is {:.3g} mm, "
                         "which gives {:.2g} points across: the grid represents the volume of the "
                         "body but not its shape; use domain.spacing_mm = {:.3g}",
                         milli(width_m), milli(h_m), width_m / h_m, milli(0.5 * width_m))});
}

/// The extent of the body along one axis, relative to the centre of the domain.
struct Reach {
    char axis;
    double low_m, high_m, half_m; // ends of the body; half width of the domain

    double furthest_m() const { return std::max(-low_m, high_m); }
    bool is_outside() const { return low_m >= half_m || high_m <= -half_m; }
    bool crosses() const { return low_m <= -half_m && high_m >= half_m; }
};

void check_place(const Case& c, std::size_t i, std::vector<Remark>& remarks) {
    const Body& body = c.scene.medium.bodies[i];
    const Bounds box = bounds(body);
    const double sponge_m = c.domain.sponge_m;
    const auto warn = [&](std::string_view key, std::string message) {
        remarks.push_back({Severity::warning, body_key(i, key), std::move(message)});
    };
    const auto* cylinder = std::get_if<Cylinder>(&body.shape);
    const bool is_endless =
        cylinder && cylinder->axis == CylinderAxis::horizontal && cylinder->is_endless();
    if (is_endless && std::isinf(box.high_m.x) && std::isinf(box.high_m.y))
        return warn("azimuth_deg",
                    fmt::format("it is infinitely long and at an angle of {:.6g} degrees, so its "
                                "ends at opposite edges of the periodic domain do not match; align "
                                "it with x or y, or give length_mm",
                                cylinder->azimuth_deg));
    for (const Reach& reach :
         {Reach{'x', box.low_m.x, box.high_m.x, 0.5 * c.domain.extent_x_m()},
          Reach{'y', box.low_m.y, box.high_m.y, 0.5 * c.domain.extent_y_m()}}) {
        if (reach.crosses()) continue; // without ends in the periodic domain
        const double beyond_m = reach.furthest_m() - reach.half_m;
        if (reach.is_outside())
            remarks.push_back(
                {Severity::error, body_key(i, "center_mm"),
                 fmt::format("it lies outside the domain and has no effect: it extends from {:.4g} "
                             "to {:.4g} mm along {}, but the domain ends at {:.4g} mm",
                             milli(reach.low_m), milli(reach.high_m), reach.axis,
                             milli(reach.half_m))});
        else if (beyond_m > 0.0 && !body.rigid) // a rigid body continues at the opposite edge
            warn("center_mm",
                 fmt::format("it reaches {:.4g} mm along {}, but the domain ends at {:.4g} mm: its "
                             "last {:.3g} mm are cut off at the periodic edge",
                             milli(reach.furthest_m()), reach.axis, milli(reach.half_m),
                             milli(beyond_m)));
        else if (sponge_m > 0.0 && beyond_m + sponge_m > 0.0)
            warn("center_mm",
                 fmt::format("it reaches {:.4g} mm along {} and thus into the margin "
                             "domain.sponge_mm, {:.4g} mm wide, at the edge of the domain at "
                             "{:.4g} mm; the margin is excluded from the measures",
                             milli(reach.furthest_m()), reach.axis, milli(sponge_m),
                             milli(reach.half_m)));
    }
}

struct Interval {
    double low_m, high_m;
    bool overlaps(const Interval& other) const {
        return low_m < other.high_m && high_m > other.low_m;
    }
    bool contains(const Interval& other) const {
        return low_m <= other.low_m && high_m >= other.high_m;
    }
};

/// The interval that the map covers along an axis; unbounded if it has a single point.
Interval reach_of_map(double origin_m, double spacing_m, std::ptrdiff_t count, Interval all) {
    if (spacing_m == 0.0) return all;
    const double last_m = origin_m + static_cast<double>(count - 1) * spacing_m;
    // A tolerance allows for rounding errors in a map that covers exactly this domain.
    return {origin_m - 0.500001 * spacing_m, last_m + 0.500001 * spacing_m};
}

void check_map(const Case& c, std::vector<Remark>& remarks) {
    const MaterialMap& map = *c.scene.medium.map;
    const double half_x_m = 0.5 * c.domain.extent_x_m(), half_y_m = 0.5 * c.domain.extent_y_m();
    // The first and last points of the grid: x_i = (i - nx/2) spacing.
    const Interval x{-half_x_m, half_x_m - c.domain.spacing_m},
        y{-half_y_m, half_y_m - c.domain.spacing_m},
        z{0.0, depths(c.scene.medium, c.scene.medium.layers.size() - 1).bottom_m};
    const Interval map_x = reach_of_map(map.origin_m.x, map.spacing_m.x, map.counts[0], x),
                   map_y = reach_of_map(map.origin_m.y, map.spacing_m.y, map.counts[1], y),
                   map_z = reach_of_map(map.origin_m.z, map.spacing_m.z, map.counts[2], z);
    const auto places = [&] {
        return fmt::format(
            "x from {:.4g} to {:.4g}, y from {:.4g} to {:.4g} and depths from {:.4g} "
            "to {:.4g} mm",
            milli(map_x.low_m), milli(map_x.high_m), milli(map_y.low_m), milli(map_y.high_m),
            milli(map_z.low_m), milli(map_z.high_m));
    };
    const Vec3 step_m = map.spacing_m;
    if (step_m.x > 20.0 * half_x_m || step_m.y > 20.0 * half_y_m || step_m.z > 10.0 * z.high_m)
        remarks.push_back({Severity::warning, "medium.map",
                           fmt::format("its points are {:.4g}, {:.4g} and {:.4g} mm apart along x, "
                                       "y and z, more than ten times the domain or the layers: are "
                                       "its coordinates in m?",
                                       milli(step_m.x), milli(step_m.y), milli(step_m.z))});
    if (!map_x.overlaps(x) || !map_y.overlaps(y) || !map_z.overlaps(z))
        remarks.push_back({Severity::error, "medium.map",
                           fmt::format("it covers {}, but no part of the domain, {:.4g} x {:.4g} "
                                       "mm about the origin: are its coordinates in m?",
                                       places(), milli(2.0 * half_x_m), milli(2.0 * half_y_m))});
    else if (!map_x.contains(x) || !map_y.contains(y))
        remarks.push_back(
            {Severity::warning, "medium.map",
             fmt::format("it covers {}, but not all of the domain of {:.4g} x {:.4g} mm; the "
                         "layers apply around it, so check the jump at its edge",
                         places(), milli(2.0 * half_x_m), milli(2.0 * half_y_m))});
}

/// The message about a body, which begins with "it", with the name that the user has given.
std::string with_name(const Body& body, std::size_t i, const std::string& message) {
    const std::string it = "it ";
    if (body.name.empty() || body.name == fmt::format("body {}", i + 1) || !message.starts_with(it))
        return message;
    return fmt::format("\"{}\" {}", body.name, message.substr(it.size()));
}

/// Whether all sides of a closed path have the same length, as those of a regular polygon.
bool is_regular(const Polyline& path) {
    const std::size_t count = path.points_m().size();
    if (path.ends() == Ends::open) return false;
    const double side_m = path.length_m() / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i)
        if (std::abs(path.arc_m(i + 1) - path.arc_m(i) - side_m) > 1e-6 * side_m) return false;
    return true;
}

/// How a list of points is followed.
std::string path_text(const Travel& travel, const Polyline& path) {
    const auto* rests = std::get_if<Rests>(&travel.motion);
    if (!rests)
        return fmt::format("load.modulation.path: {} points, followed along straight lines of "
                           "{:.6g} mm without rests; columns dwell_ms or t_ms of a CSV file make "
                           "the focus rest at each point",
                           path.points_m().size(), milli(path.length_m()));
    double least_s = rests->ends_s.front(), most_s = least_s;
    for (std::size_t i = 1; i < rests->ends_s.size(); ++i) {
        least_s = std::min(least_s, rests->ends_s[i] - rests->ends_s[i - 1]);
        most_s = std::max(most_s, rests->ends_s[i] - rests->ends_s[i - 1]);
    }
    std::string text = fmt::format(
        "load.modulation.path: the focus rests at {} points for {:.6g} to {:.6g} ms "
        "each and jumps between them; a pass takes {:.6g} ms (at_end = \"{}\")",
        rests->ends_s.size(), milli(least_s), milli(most_s), milli(rests->ends_s.back()),
        names_of(std::type_identity<AtEnd>{})[static_cast<std::size_t>(travel.at_end)]);
    if (!rests->levels.empty()) {
        const auto [low, high] = std::ranges::minmax(rests->levels);
        text += fmt::format("; level {:.6g} to {:.6g} of the force", low, high);
    }
    return text;
}

} // namespace

std::vector<std::string> files_read(const Case& c) {
    std::vector<std::string> lines;
    if (c.scene.medium.map)
        lines.push_back(fmt::format("medium.map {}: {}", c.scene.medium.map->file,
                                    c.scene.medium.map->contents));
    for (const Mover& part : c.scene.load.modulation.trajectory.parts) {
        const auto* travel = std::get_if<Travel>(&part);
        if (const auto* points = travel ? std::get_if<Polyline>(&travel->path.shape) : nullptr;
            points && !is_regular(*points))
            lines.push_back(path_text(*travel, *points));
    }
    return lines;
}

std::vector<Remark> check_variation(const Case& c) {
    std::vector<Remark> remarks;
    for (std::size_t i = 0; i < c.scene.medium.bodies.size(); ++i) {
        const std::size_t before = remarks.size();
        check_resolution(c, i, remarks);
        check_place(c, i, remarks);
        for (std::size_t n = before; n < remarks.size(); ++n)
            remarks[n].message = with_name(c.scene.medium.bodies[i], i, remarks[n].message);
    }
    if (c.scene.medium.map) check_map(c, remarks);
    return remarks;
}

} // namespace shearwake
