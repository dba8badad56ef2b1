// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"

#include <variant>

namespace shearwake::config {

// Descriptions of keys that exist only in job files, from which config derives arcs, polylines and
// plans. The reader, the schema and the reference of keys use them like those of a case
// (base/field.hpp).

/// Shapes of paths that become arcs and polylines.
struct CircleKeys {
    static constexpr const char* name = "circle";
};
template <class Walk, Is<CircleKeys> Keys>
void walk_fields(Walk& walk, Keys&) {
    walk.key({.key = "center_mm", .type = "point", .fallback = "[0, 0]", .meaning = "centre"});
    walk.key({.key = "radius_mm",
              .range = Range::between(0.0, 1e4),
              .given = Given::required,
              .type = "number",
              .meaning = "radius; at least 0.001, except as the pattern of STP"});
    walk.key({.key = "start_deg",
              .type = "number",
              .fallback = "0",
              .meaning = "angle of the starting point, from x towards y"});
    walk.key({.key = "clockwise",
              .type = "boolean",
              .fallback = "false",
              .meaning = "direction of the motion"});
}

struct PolygonKeys {
    static constexpr const char* name = "polygon";
};
template <class Walk, Is<PolygonKeys> Keys>
void walk_fields(Walk& walk, Keys&) {
    constexpr Range lengths = Range::between(1e-3, 1e4);
    walk.key({.key = "corners_mm",
              .type = "points",
              .fallback = "none",
              .meaning =
                  "corners `[[x, y], ...]`, at least three; the last one is connected with the "
                  "first. The other keys of this table define a regular polygon instead"});
    walk.key({.key = "sides",
              .range = Range::between(3, 1000),
              .type = "integer",
              .fallback = "required without `corners_mm`",
              .meaning = "number of sides of a regular polygon"});
    walk.key({.key = "side_mm",
              .range = lengths,
              .type = "number",
              .fallback = "or `radius_mm`",
              .meaning = "length of a side"});
    walk.key({.key = "radius_mm",
              .range = lengths,
              .type = "number",
              .fallback = "or `side_mm`",
              .meaning = "distance of the corners from the centre"});
    walk.key({.key = "center_mm", .type = "point", .fallback = "[0, 0]", .meaning = "centre"});
    walk.key({.key = "start_deg",
              .type = "number",
              .fallback = "the polygon stands on a side",
              .meaning = "angle of the first corner, from x towards y"});
}

struct PathFileKeys {
    static constexpr const char* name = "csv";
};
template <class Walk, Is<PathFileKeys> Keys>
void walk_fields(Walk& walk, Keys&) {
    walk.key({.key = "file",
              .given = Given::required,
              .type = "file",
              .meaning = "CSV file of points; its path is relative to the job file. It has the "
                         "header `x_mm,y_mm` and one point per line"});
    walk.key({.key = "closed",
              .type = "boolean",
              .fallback = "false",
              .meaning = "whether the path returns to its first point"});
}

using PathShapes = std::variant<CircleKeys, PolygonKeys, PathFileKeys>;

/// The options of [uncertain]; its other keys are uncertain keys with their distributions.
struct UncertainTableKeys {};
template <class Walk, Is<UncertainTableKeys> Keys>
void walk_fields(Walk& walk, Keys&) {
    walk.key({.key = "samples",
              .range = Range::between(2.0, 1e12),
              .given = Given::required,
              .type = "integer",
              .meaning = "number of samples"});
    walk.key({.key = "seed",
              .range = Range::between(0.0, 9007199254740992.0),
              .type = "integer",
              .fallback = "1",
              .meaning = "seed of the random numbers; at most 2^53, exact as a number"});
}

} // namespace shearwake::config
