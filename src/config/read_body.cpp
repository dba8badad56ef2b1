#include "config/read_case.hpp"

#include "config/presets.hpp"
#include "model/bulk_modulus.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace shearwake {
namespace {

std::string in_milli(double x_SI) {
    return fmt::format("{:.6g}", 1e3 * x_SI);
}

/// [x, y, z]; something harmless after a mistake.
Vec3 read_triple(Reader& reader, std::string_view key, const Range& range) {
    if (!reader.has(key)) reader.missing(key);
    const auto values = reader.find_numbers(key, range);
    if (values && values->size() != 3)
        reader.error(key,
                     fmt::format("must be three numbers [x, y, z], and has {}", values->size()));
    return values && values->size() == 3 ? Vec3{(*values)[0], (*values)[1], (*values)[2]}
                                         : Vec3{1.0, 1.0, 1.0};
}

/// In degrees again, without the roundings of the way through radians: 30, not 30.000000000000004.
double in_degrees(double angle_rad) {
    constexpr double parts = 1e9; // of a degree
    return std::round(angle_rad * 180.0 / std::numbers::pi * parts) / parts;
}

Cylinder read_cylinder(Reader& reader) {
    static const std::array<std::string, 3> axes = {"x", "y", "z"};
    Cylinder cylinder;
    cylinder.radius_m = reader.number("radius_mm", Range::above(0.0));
    cylinder.length_m = reader.number_or("length_mm", 0.0, Range::above(0.0));
    const auto axis = reader.find_choice("axis", axes);
    const auto azimuth_rad = reader.find_number("azimuth_deg", Range::between(-360.0, 360.0));
    if (reader.has("axis") && reader.has("azimuth_deg"))
        reader.error("azimuth_deg", "and axis are both given; one of them says it all");
    else if (!reader.has("axis") && !reader.has("azimuth_deg"))
        reader.missing("axis");
    if (axis == "y") cylinder.azimuth_deg = 90.0;
    if (axis == "z") cylinder.axis = CylinderAxis::vertical;
    if (azimuth_rad) cylinder.azimuth_deg = in_degrees(*azimuth_rad);
    return cylinder;
}

/// `center_mm` is [x, y, z], or [x, y] beside `depth_mm`, which a sweep can reach as a number.
Vec3 read_centre_m(Reader& reader, bool has_depth) {
    const auto depth_m = reader.find_number("depth_mm", Range::any());
    const auto values = reader.find_numbers("center_mm", Range::any());
    if (!reader.has("center_mm")) reader.missing("center_mm");
    if (!values) return {0.0, 0.0, depth_m.value_or(0.0)};
    if (values->size() != 2 && values->size() != 3) {
        reader.error("center_mm", fmt::format("must be [x, y, z], or [x, y] beside depth_mm, and "
                                              "has {} values",
                                              values->size()));
        return {};
    }
    const bool is_whole = values->size() == 3;
    if (is_whole && reader.has("depth_mm"))
        reader.error("depth_mm", "is given by center_mm = [x, y, z] as well; leave its z out, or "
                                 "this key");
    if (!is_whole && !reader.has("depth_mm") && has_depth) reader.missing("depth_mm");
    return {(*values)[0], (*values)[1], is_whole ? (*values)[2] : depth_m.value_or(0.0)};
}

void read_properties(Reader& reader, Body& body) {
    body.density_kg_m3 = reader.find_number("density_kg_m3", Range::above(0.0));
    body.c_p_m_s = reader.find_number("c_p_m_s", Range::above(0.0));
    body.c_s_m_s = reader.find_number("c_s_m_s", Range::at_least(0.0));
    body.viscosity_Pa_s = reader.find_number("viscosity_Pa_s", Range::at_least(0.0));
    for (const char* key : {"density_kg_m3", "c_p_m_s", "c_s_m_s", "viscosity_Pa_s"})
        if (reader.has(key)) return;
    reader.error("shape", "is of no other material than what is around it: give density_kg_m3, "
                          "c_p_m_s, c_s_m_s, viscosity_Pa_s or a preset");
}

void check_edge(const Reader& reader, const Body& body) {
    if (body.edge_m > thickness_m(body))
        reader.error("edge_mm", fmt::format("must fit into the body: at most {}, its smallest "
                                            "width, and is {}",
                                            in_milli(thickness_m(body)), in_milli(body.edge_m)));
}

/// At least a part of it lies in the medium.
void check_depth(const Reader& reader, const char* key, const Body& body, const Medium& medium) {
    const double bottom_m = depths(medium, medium.layers.size() - 1).bottom_m;
    const Bounds box = bounds(body);
    if (box.high_m.z <= 0.0)
        reader.error(key, fmt::format("leaves the body above the surface: z counts from there "
                                      "downward, and the body ends at {} mm",
                                      in_milli(box.high_m.z)));
    else if (box.low_m.z >= bottom_m)
        reader.error(key, fmt::format("leaves the body below the rigid base, {} mm deep: it begins "
                                      "at {} mm",
                                      in_milli(bottom_m), in_milli(box.low_m.z)));
}

/// What the body does not give is that of each layer it lies in.
void check_bulk_modulus(const Reader& reader, const Body& body, const Medium& medium) {
    if (!body.c_p_m_s && !body.c_s_m_s) return; // the layer's or the map's mistake, if it is one
    const Bounds box = bounds(body);
    for (std::size_t i = 0; i < medium.layers.size(); ++i) {
        const DepthRange layer = depths(medium, i);
        if (box.low_m.z >= layer.bottom_m || box.high_m.z <= layer.top_m) continue;
        const Speeds speeds = softest_against_pressure(medium, i, &body);
        if (has_positive_bulk_modulus(speeds)) continue;
        reader.error(
            body.c_p_m_s ? "c_p_m_s" : "c_s_m_s",
            fmt::format("makes c_p = {:.6g} and c_s = {:.6g} m/s in layer \"{}\": c_p must "
                        "be above {:.6g}, 1.1547 times c_s (a positive bulk modulus)",
                        speeds.c_p_m_s, speeds.c_s_m_s, excerpt(medium.layers[i].name),
                        speeds.c_s_m_s * least_speed_ratio));
        return;
    }
}

} // namespace

Body read_body(Reader reader, std::size_t number, const Medium& medium) {
    static const std::array<std::string, 3> shapes = {"ellipsoid", "cylinder", "box"};
    const std::size_t before = reader.findings().errors();
    if (reader.has("preset")) reader.find_choice("preset", body_preset_names());
    Body body;
    body.name = reader.find_word("name").value_or(fmt::format("body {}", number));
    if (!reader.has("shape")) reader.missing("shape");
    const std::string shape = reader.find_choice("shape", shapes).value_or("");
    bool has_depth = true;
    if (shape == "ellipsoid")
        body.shape = Ellipsoid{read_triple(reader, "semi_axes_mm", Range::above(0.0))};
    if (shape == "box") body.shape = Box{read_triple(reader, "size_mm", Range::above(0.0))};
    if (shape == "cylinder") {
        const Cylinder cylinder = read_cylinder(reader);
        has_depth = cylinder.axis == CylinderAxis::horizontal || !cylinder.is_endless();
        body.shape = cylinder;
    }
    body.centre_m = read_centre_m(reader, has_depth);
    body.edge_m = reader.number_or("edge_mm", 0.0, Range::at_least(0.0));
    read_properties(reader, body);
    if (shape.empty()) // its keys may be any shape's
        reader.allow(std::array<std::string_view, 6>{"semi_axes_mm", "size_mm", "radius_mm",
                                                     "length_mm", "axis", "azimuth_deg"});
    reader.finish();
    if (reader.findings().errors() != before || medium.layers.empty()) return body;
    check_edge(reader, body);
    check_depth(reader, reader.has("depth_mm") ? "depth_mm" : "center_mm", body, medium);
    check_bulk_modulus(reader, body, medium);
    return body;
}

} // namespace shearwake
