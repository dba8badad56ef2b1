#pragma once

#include "base/vec3.hpp"

#include <optional>
#include <string>
#include <variant>

namespace shearwake {

struct Ellipsoid {
    Vec3 semi_axes_m;
    bool operator==(const Ellipsoid&) const = default;
};

/// Bone or vessel. A horizontal axis lies at the azimuth from x, counted towards y; a vertical one
/// needs none. Length 0 or infinity: it crosses the whole domain.
enum class CylinderAxis { horizontal, vertical };
struct Cylinder {
    double radius_m = 0.0;
    double length_m = 0.0;
    double azimuth_deg = 0.0;
    CylinderAxis axis = CylinderAxis::horizontal;
    bool operator==(const Cylinder&) const = default;

    bool is_endless() const;
};

/// Edges along x, y and z.
struct Box {
    Vec3 size_m;
    bool operator==(const Box&) const = default;
};

/// Something that lies in the layers and is made of another material.
struct Body {
    std::string name;
    std::variant<Ellipsoid, Cylinder, Box> shape;
    Vec3 centre_m;
    double edge_m = 0.0; // width of the smooth transition; 0: a sharp face, so one cell of the grid
    // What is not given is that of the layer around.
    std::optional<double> density_kg_m3, c_p_m_s, c_s_m_s, viscosity_Pa_s; // c_s 0: a fluid
    bool operator==(const Body&) const = default;
};

inline bool is_fluid(const Body& body) {
    return body.c_s_m_s == 0.0;
}

/// Share of the cell that the body fills, 0 to 1, averaged over sub-samples at places symmetric
/// about the cell's centre: mirrored bodies give mirrored shares to rounding. A size may be 0 along
/// an axis, then the cell is flat there. A sharp face: the planar share of each sub-sample. An edge
/// is a C-infinity profile of the signed distance (exact for boxes and cylinders, approximate for
/// ellipsoids), half-way at the face and exactly 0 and 1 half an edge beyond it. A round face gains
/// volume with its edge w: a cylinder 0.036 (w/R)^2, a sphere 0.109 (w/R)^2.
double volume_fraction(const Body& body, Vec3 centre_m, Vec3 size_m);

/// The box outside of which the share is exactly 0, the edge included; infinite along an endless
/// cylinder.
struct Bounds {
    Vec3 low_m, high_m;
    bool operator==(const Bounds&) const = default;
};
Bounds bounds(const Body& body);

/// The smallest width of the body, which an edge must fit into.
double thickness_m(const Body& body);
/// The same in the x-y plane: what the lateral grid must resolve.
double lateral_thickness_m(const Body& body);

} // namespace shearwake
