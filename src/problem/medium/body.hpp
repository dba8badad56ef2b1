// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"

#include <optional>
#include <string>
#include <variant>

namespace shearwake {

/// Orientation of a body: roll about its own x axis, then the tilt of this axis downwards, then a
/// turn about the vertical. With these ranges, every orientation is possible.
struct Orientation {
    double azimuth_deg = 0.0;     // from x towards y
    double inclination_deg = 0.0; // of the body's own x axis, downwards
    double roll_deg = 0.0;        // about the body's own x axis, from its y axis towards its z axis
    bool operator==(const Orientation&) const = default;
};

constexpr Range azimuth_range = Range::between(-360.0, 360.0);
constexpr Range inclination_range = Range::between(-90.0, 90.0);
constexpr Range roll_range = Range::between(-360.0, 360.0);

/// The axes of a body as unit vectors: the columns of its rotation matrix.
struct BodyAxes {
    Vec3 x{1.0, 0.0, 0.0}, y{0.0, 1.0, 0.0}, z{0.0, 0.0, 1.0};
    bool operator==(const BodyAxes&) const = default;

    /// A vector given along the axes of the body, along those of the medium.
    Vec3 to_medium(Vec3 v) const { return v.x * x + v.y * y + v.z * z; }
    Vec3 to_body(Vec3 v) const { return {along(x, v), along(y, v), along(z, v)}; }

private:
    static double along(Vec3 axis, Vec3 v) { return axis.x * v.x + axis.y * v.y + axis.z * v.z; }
};

/// Exact at multiples of 90 degrees.
BodyAxes axes_of(const Orientation& orientation);

struct Ellipsoid {
    static constexpr const char* name = "ellipsoid";
    Vec3 semi_axes_m;
    Orientation orientation = {};
    bool operator==(const Ellipsoid&) const = default;
};

/// Bone or vessel. An axis that is not vertical has an azimuth, from x towards y, and an
/// inclination, downwards; CylinderAxis::vertical has neither. Length 0 or infinity: the cylinder
/// crosses the whole domain, and its axis has no inclination.
enum class CylinderAxis { horizontal, vertical };
constexpr auto names_of(std::type_identity<CylinderAxis>) {
    return std::array{"horizontal", "vertical"};
}
struct Cylinder {
    static constexpr const char* name = "cylinder";
    double radius_m = 0.0;
    double length_m = 0.0;
    double azimuth_deg = 0.0;
    CylinderAxis axis = CylinderAxis::horizontal;
    double inclination_deg = 0.0;
    bool operator==(const Cylinder&) const = default;

    bool is_endless() const;
};

/// Edges along its own axes.
struct Box {
    static constexpr const char* name = "box";
    Vec3 size_m;
    Orientation orientation = {};
    bool operator==(const Box&) const = default;
};

/// A region in the layers that has a different material.
struct Body {
    std::string name;
    std::variant<Ellipsoid, Cylinder, Box> shape;
    Vec3 centre_m;
    double edge_m = 0.0; // width of the smooth transition; 0: a sharp face, averaged over each cell
    // Properties that are not given are those of the surrounding layer.
    std::optional<double> density_kg_m3, c_p_m_s, c_s_m_s, viscosity_Pa_s; // c_s 0: a fluid
    bool rigid = false; // does not deform: only the density of its material matters
    bool fixed = false; // and does not move
    bool operator==(const Body&) const = default;
};

inline bool is_fluid(const Body& body) {
    return body.c_s_m_s == 0.0;
}

/// The axes of a body. The axis of a cylinder is x, or z if it is CylinderAxis::vertical.
BodyAxes axes_of(const Body& body);
/// Whether it is an ellipsoid or a box with an orientation, or an inclined cylinder.
bool is_turned(const Body& body);
/// The body without its orientation: a turned cylinder lies along x. Bodies that are not turned
/// remain as they are.
Body aligned(Body body);

/// Fraction of the cell that the body fills, from 0 to 1, averaged over sub-samples that are
/// symmetric about the centre of the cell: mirrored bodies give mirrored fractions up to rounding.
/// A cell may have size 0 along an axis. For a sharp face, each sub-sample contributes its fraction
/// behind the tangent plane. An edge is a C-infinity profile of the signed distance (exact for
/// boxes and cylinders, approximate for ellipsoids), which is 1/2 at the face and exactly 0 and 1
/// at half the edge width from it. An edge of width w increases the volume of curved bodies: of a
/// cylinder by 0.036 (w/R)^2, of a sphere by 0.109 (w/R)^2.
double volume_fraction(const Body& body, Vec3 centre_m, Vec3 size_m);

/// The box outside of which the fraction is exactly 0, including the edge; infinite along an
/// infinite cylinder.
struct Bounds {
    Vec3 low_m, high_m;
    bool operator==(const Bounds&) const = default;
};
Bounds bounds(const Body& body);
/// Whether both bodies contain the centre of a box, or of one of the boxes that result if its sides
/// are halved this many times.
bool share_a_point(const Body& a, const Body& b, const Bounds& box, int halvings);

/// The smallest width of the body, an upper limit of the edge width.
double thickness_m(const Body& body);
/// The smallest width in the x-y plane, which the lateral grid must resolve.
double lateral_thickness_m(const Body& body);

} // namespace shearwake
