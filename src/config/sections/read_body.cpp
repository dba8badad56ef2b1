// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"

#include "config/document/presets.hpp"
#include "config/sections/read_fields.hpp"
#include "problem/medium/material_field.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace shearwake::config {
namespace {

/// Converts back to degrees without rounding errors from the conversion to radians: 30, not
/// 30.000000000000004.
double in_degrees(double angle_rad) {
    constexpr double parts = 1e9; // of a degree
    return std::round(angle_rad * 180.0 / std::numbers::pi * parts) / parts;
}

double read_angle_deg(Reader& reader, const char* key, const Range& range) {
    const auto angle_rad = reader.find_number(key, range);
    return angle_rad ? in_degrees(*angle_rad) : 0.0;
}

Orientation read_orientation(Reader& reader) {
    return {read_angle_deg(reader, "azimuth_deg", azimuth_range),
            read_angle_deg(reader, "inclination_deg", inclination_range),
            read_angle_deg(reader, "roll_deg", roll_range)};
}

void read_direction(Reader& reader, Cylinder& cylinder) {
    static const std::array<std::string, 3> axes = {"x", "y", "z"};
    const auto axis = reader.find_choice("axis", axes);
    const double azimuth_deg = read_angle_deg(reader, "azimuth_deg", azimuth_range);
    const double inclination_deg = read_angle_deg(reader, "inclination_deg", inclination_range);
    if (reader.has("axis") && reader.has("azimuth_deg"))
        reader.conflict("azimuth_deg", "and axis are both given; remove one of them from the job");
    else if (!reader.has("axis") && !reader.has("azimuth_deg"))
        reader.missing(reader.has("inclination_deg") ? "azimuth_deg" : "axis");
    else if (reader.has("axis") && reader.has("inclination_deg"))
        reader.conflict("inclination_deg",
                        "and axis are both given; give azimuth_deg instead of axis");
    if (inclination_deg != 0.0 && cylinder.is_endless())
        reader.error("inclination_deg",
                     "requires length_mm, since a cylinder without ends must lie horizontally "
                     "or have axis = \"z\"");
    if (axis == "y") cylinder.azimuth_deg = 90.0;
    if (axis == "z") cylinder.axis = CylinderAxis::vertical;
    if (reader.has("azimuth_deg")) {
        cylinder.azimuth_deg = azimuth_deg;
        cylinder.inclination_deg = inclination_deg;
    }
}

/// `center_mm` is [x, y, z], or [x, y] together with `depth_mm`, which can be swept as a number.
Vec3 read_centre_m(Reader& reader, bool has_depth) {
    const auto depth_m = reader.find_number("depth_mm", range_of<Body>("depth_mm"));
    const auto values = reader.find_numbers("center_mm", range_of<Body>("center_mm"));
    if (!reader.has("center_mm")) reader.missing("center_mm");
    if (!values) return {0.0, 0.0, depth_m.value_or(0.0)};
    if (values->size() != 2 && values->size() != 3) {
        reader.error("center_mm",
                     fmt::format("must be [x, y, z], or [x, y] with depth_mm, but has {} values",
                                 values->size()));
        return {};
    }
    const bool is_complete = values->size() == 3;
    if (is_complete && reader.has("depth_mm"))
        reader.conflict("depth_mm",
                        "and the z of center_mm = [x, y, z] are both given; remove one of them");
    if (!is_complete && !reader.has("depth_mm") && has_depth) reader.missing("depth_mm");
    return {(*values)[0], (*values)[1], is_complete ? (*values)[2] : depth_m.value_or(0.0)};
}

void check_properties(Reader& reader, const Body& body) {
    if (body.rigid || reader.has("preset")) return; // the keys of a known preset are in the table
    for (const char* key : {"density_kg_m3", "c_p_m_s", "c_s_m_s", "viscosity_Pa_s"})
        if (reader.has(key) || reader.has_misspelled(key)) return;
    reader.error("shape", "has the same material as its surroundings; give density_kg_m3, c_p_m_s, "
                          "c_s_m_s, viscosity_Pa_s or a preset");
}

void check_edge(const Reader& reader, const Body& body) {
    if (body.edge_m > thickness_m(body))
        reader.error("edge_mm",
                     fmt::format("must not exceed {}, the smallest width of the body, but is {}",
                                 in_milli(thickness_m(body)), in_milli(body.edge_m)));
}

/// Checks that at least a part of the body lies inside the medium.
void check_depth(const Reader& reader, const char* key, const Body& body, const Medium& medium) {
    const double bottom_m = depths(medium, medium.layers.size() - 1).bottom_m;
    const Bounds box = bounds(body);
    if (box.high_m.z <= 0.0)
        reader.error(key, fmt::format("places the body above the surface: z is counted downward "
                                      "from the surface, and the body ends at {} mm",
                                      in_milli(box.high_m.z)));
    else if (box.low_m.z >= bottom_m)
        reader.error(
            key,
            fmt::format("places the body below the rigid base at {} mm: the body begins at {} mm",
                        in_milli(bottom_m), in_milli(box.low_m.z)));
}

/// Properties that the body does not give are those of each layer that it intersects.
void check_bulk_modulus(const Reader& reader, const Body& body, const Medium& medium) {
    if (!body.c_p_m_s && !body.c_s_m_s) return; // reported for the layer or the map
    const Bounds box = bounds(body);
    for (std::size_t i = 0; i < medium.layers.size(); ++i) {
        const DepthRange layer = depths(medium, i);
        if (box.low_m.z >= layer.bottom_m || box.high_m.z <= layer.top_m) continue;
        const Speeds speeds = softest_against_pressure(medium, i, &body);
        if (has_positive_bulk_modulus(speeds)) continue;
        reader.error(
            body.c_p_m_s ? "c_p_m_s" : "c_s_m_s",
            fmt::format("gives c_p = {:.6g} and c_s = {:.6g} m/s in layer \"{}\": c_p must be "
                        "above {:.6g}, 1.1547 times c_s, for a positive bulk modulus",
                        speeds.c_p_m_s, speeds.c_s_m_s, excerpt(medium.layers[i].name),
                        speeds.c_s_m_s * least_speed_ratio));
        return;
    }
}

} // namespace

Body read_body(Reader reader, std::size_t number, const Medium& medium) {
    const std::size_t before = reader.diagnostics().errors();
    if (reader.has("preset")) reader.find_choice("preset", body_preset_names());
    Body body;
    body.name = fmt::format("body {}", number);
    read_fields(reader, body);
    if (!reader.has("shape")) reader.missing("shape");
    using Shape = decltype(Body::shape);
    const std::string shape = reader.find_choice("shape", alternative_names<Shape>()).value_or("");
    if (const auto read = read_alternative<Shape>(reader, shape)) body.shape = *read;
    bool has_depth = true;
    const auto read_axis = [&](Cylinder& cylinder) {
        read_direction(reader, cylinder);
        has_depth = cylinder.axis == CylinderAxis::horizontal || !cylinder.is_endless();
    };
    const auto read_turn = [&](auto& of) { of.orientation = read_orientation(reader); };
    if (!shape.empty())
        std::visit(overloaded{[&](Ellipsoid& ellipsoid) { read_turn(ellipsoid); }, read_axis,
                              [&](Box& box) { read_turn(box); }},
                   body.shape);
    body.centre_m = read_centre_m(reader, has_depth);
    check_properties(reader, body);
    if (shape.empty()) // its keys may belong to any shape
        reader.allow(std::array<std::string_view, 8>{"semi_axes_mm", "size_mm", "radius_mm",
                                                     "length_mm", "axis", "azimuth_deg",
                                                     "inclination_deg", "roll_deg"});
    reader.finish();
    if (reader.diagnostics().errors() != before || medium.layers.empty()) return body;
    check_edge(reader, body);
    check_depth(reader, reader.has("depth_mm") ? "depth_mm" : "center_mm", body, medium);
    check_bulk_modulus(reader, body, medium);
    return body;
}

} // namespace shearwake::config
