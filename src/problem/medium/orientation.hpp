// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"

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

template <class Walk, Is<Orientation> O>
void walk_fields(Walk& walk, O& o) {
    walk(o.azimuth_deg, {.key = "azimuth_deg",
                         .text = "azimuth_deg",
                         .range = azimuth_range,
                         .given = Given::by_hand,
                         .in_text = o.azimuth_deg != 0.0,
                         .meaning = "turn about the vertical, from x towards y"});
    walk(o.inclination_deg,
         {.key = "inclination_deg",
          .text = "inclination_deg",
          .range = inclination_range,
          .given = Given::by_hand,
          .in_text = o.inclination_deg != 0.0,
          .meaning = "tilt of the body's own x axis out of the horizontal plane, downwards"});
    walk(o.roll_deg,
         {.key = "roll_deg",
          .text = "roll_deg",
          .range = roll_range,
          .given = Given::by_hand,
          .in_text = o.roll_deg != 0.0,
          .meaning = "turn of the body about its own x axis, from its y axis towards "
                     "its z axis. The azimuth and the inclination then turn this axis"});
}

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

} // namespace shearwake
