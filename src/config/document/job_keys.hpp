// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"
#include "problem/case/plan.hpp"
#include "sampling/design.hpp"

#include <variant>
#include <vector>

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
                  "first. The other keys of this table define a regular polygon instead",
              .least_count = 3});
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
                         "header `x_mm,y_mm` and one point per line; with the further column "
                         "`dwell_ms` or `t_ms` the focus rests at each point"});
    walk.key({.key = "closed",
              .type = "boolean",
              .fallback = "false",
              .meaning = "whether the path returns to its first point"});
}

using PathShapes = std::variant<CircleKeys, PolygonKeys, PathFileKeys>;

/// What a path that must have a length requires in addition to the keys of its shape; the pattern
/// of STP may be a point.
struct PathLengthKeys {};
template <class Walk, Is<PathLengthKeys> Keys>
void walk_fields(Walk& walk, Keys&) {
    walk.key({.key = "radius_mm",
              .range = Range::between(1e-3, 1e4),
              .type = "number",
              .meaning = "radius; it must not be 0, so that the path has a length"});
}

/// Inline tables of [afferents] that become lists of pins.
struct PinLineKeys {
    static constexpr const char* name = "pin_line";
    Vec2 from_m, to_m;
    int count = 2;
};
template <class Walk, Is<PinLineKeys> Keys>
void walk_fields(Walk& walk, Keys& line) {
    walk(line.from_m,
         {.key = "from_mm", .given = Given::required, .meaning = "position of the first pin"});
    walk(line.to_m,
         {.key = "to_mm", .given = Given::required, .meaning = "position of the last pin"});
    walk(line.count, {.key = "count",
                      .range = Range::between(2.0, 1000.0),
                      .given = Given::required,
                      .meaning = "number of pins"});
}

struct PinGridKeys {
    static constexpr const char* name = "pin_grid";
    Vec2 extent_m, center_m;
    double pitch_m = 0.0;
};
template <class Walk, Is<PinGridKeys> Keys>
void walk_fields(Walk& walk, Keys& grid) {
    walk(grid.extent_m, {.key = "extent_mm",
                         .range = Range::between(0.0, 1e4),
                         .given = Given::required,
                         .meaning = "size of the grid"});
    walk(grid.pitch_m, {.key = "pitch_mm",
                        .range = Range::between(1e-3, 1e4),
                        .given = Given::required,
                        .meaning = "spacing of the pins"});
    walk(grid.center_m, {.key = "center_mm", .meaning = "centre of the grid, where a pin is"});
}

using InlineTables = std::variant<PinLineKeys, PinGridKeys>;

/// Calls `use` with the keys of a table that is described here.
void with_inline_table(const Field& field, const auto& use) {
    for_each_alternative(std::type_identity<InlineTables>{}, [&](const auto& keys) {
        if (field.key == std::string_view(keys.name)) use(keys);
    });
}

// The tables of a job that are not those of a case.

/// [job].
struct JobTableKeys {};
template <class Walk, Is<JobTableKeys> Keys>
void walk_fields(Walk& walk, Keys&) {
    walk.key({.key = "name",
              .given = Given::required,
              .type = "name",
              .meaning = "name of the study and of its output folder: letters, digits, `-`, `_` "
                         "and `.`"});
    walk.key({.key = "title",
              .type = "word",
              .fallback = "the name",
              .meaning = "title in tables and reports"});
    walk.key({.key = "question",
              .type = "word",
              .fallback = "the first question of the comment at the beginning of the file",
              .meaning = "the question that the report answers"});
    walk.key({.key = "answer",
              .type = "word",
              .fallback = "follows from the columns and the question",
              .meaning = "the column of the table that answers the question, for example "
                         "`\"felt_path_dB\"`"});
}

/// The options of [sweep]; its other keys are swept keys with their values.
struct SweepTableKeys {};
template <class Walk, Is<SweepTableKeys> Keys>
void walk_fields(Walk& walk, Keys&) {
    walk.key({.key = "list",
              .type = "file",
              .fallback = "none",
              .meaning = "CSV file of an axis: the first line contains full keys, and each further "
                         "line their values in one case"});
    walk.key({.key = "zip",
              .type = "tables",
              .fallback = "none",
              .meaning = "keys that change together, with their values; one axis per table"});
    walk.key({.key = "exclude",
              .type = "tables",
              .fallback = "none",
              .meaning = "combinations of values whose cases are left out"});
}

/// The values of a swept key: three numbers that generate them, or an adaptive axis.
struct AxisKeys {
    std::size_t initial = AdaptiveAxis{}.initial, most = AdaptiveAxis{}.most;
};
template <class Walk, Is<AxisKeys> Keys>
void walk_fields(Walk& walk, Keys& axis) {
    constexpr Range counts = Range::between(2.0, 1e4), points = Range::between(3.0, 1e4);
    walk.key({.key = "linspace",
              .range = counts,
              .type = "ends and count",
              .fallback = "none",
              .meaning = "`[first, last, count]`: equally spaced values"});
    walk.key({.key = "logspace",
              .range = counts,
              .type = "ends and count",
              .fallback = "none",
              .meaning = "`[first, last, count]`: values with equal ratios"});
    walk.key(
        {.key = "range", .type = "triple", .fallback = "none", .meaning = "`[start, stop, step]`"});
    walk.key({.key = "refine",
              .type = "point",
              .fallback = "none",
              .meaning = "`[first, last]`: points are added where `column` is not yet resolved"});
    walk.key({.key = "find",
              .type = "word:maximum|minimum|crossing",
              .fallback = "none",
              .meaning = "point of `column` that is located"});
    walk.key({.key = "in",
              .type = "point",
              .fallback = "required with `find`",
              .meaning = "`[first, last]`: interval in which the point is sought"});
    walk.key({.key = "level",
              .type = "number",
              .fallback = "the reference of `[table]`",
              .meaning = "with `find = \"crossing\"`: value that is crossed"});
    walk.key({.key = "column",
              .type = "word",
              .fallback = "required with `refine` and `find`",
              .meaning = "column of the table"});
    walk.key({.key = "tolerance",
              .range = Range::above(0.0),
              .type = "number",
              .fallback = "required with `refine` and `find`",
              .meaning = "of `refine`: error of `column`; of `find`: error of the swept key"});
    walk.key({.key = "smallest_step",
              .range = Range::above(0.0),
              .type = "number",
              .fallback = "a thousandth of the interval",
              .meaning = "of `refine`: least distance of two points"});
    walk(axis.initial,
         {.key = "initial", .range = points, .meaning = "number of points of the first round"});
    walk(axis.most, {.key = "most", .range = points, .meaning = "largest number of points"});
}

/// The distribution of an uncertain key. Which keys apply depends on the distribution.
struct DistributionKeys {
    double density_kg_m3 = 1000.0;
};
template <class Walk, Is<DistributionKeys> Keys>
void walk_fields(Walk& walk, Keys& keys) {
    walk.key({.key = "preset",
              .type = "word",
              .fallback = "none",
              .meaning = "published distribution, instead of the other keys"});
    walk.key({.key = "distribution",
              .type = "word:uniform|normal|lognormal|triangular|csv",
              .fallback = "required without a preset",
              .meaning = "its shape"});
    const auto number = [&](const char* key, const char* fallback, const char* meaning) {
        walk.key({.key = key, .type = "number", .fallback = fallback, .meaning = meaning});
    };
    number("min", "none", "lower end; of other shapes than uniform and triangular: truncation");
    number("max", "none", "upper end; of other shapes than uniform and triangular: truncation");
    number("mode", "required", "of triangular: most likely value");
    number("mean", "required", "of normal");
    number("sd", "required", "of normal: standard deviation");
    number("median", "required", "of lognormal");
    number("geometric_sd", "required", "of lognormal: geometric standard deviation");
    walk.key({.key = "file", .type = "file", .fallback = "required", .meaning = "of csv: values"});
    walk.key({.key = "column",
              .type = "word",
              .fallback = "required",
              .meaning = "of csv: column of the file"});
    walk.key({.key = "of",
              .type = "word:youngs_modulus_kPa|shear_modulus_kPa",
              .fallback = "the key itself",
              .meaning = "modulus that has this distribution, from which c_s follows"});
    walk(keys.density_kg_m3, {.key = "density_kg_m3",
                              .range = Range::between(100.0, 10000.0),
                              .meaning = "with `of`: density"});
}

/// [table].
struct TableKeys {};
template <class Walk, Is<TableKeys> Keys>
void walk_fields(Walk& walk, Keys&) {
    walk.key({.key = "x",
              .type = "word",
              .fallback = "the first axis",
              .meaning = "swept key on the horizontal axis of the figures"});
    walk.key({.key = "series",
              .type = "words",
              .fallback = "the other axes",
              .meaning = "swept keys with one curve per value"});
    walk.key({.key = "labels",
              .type = "table",
              .fallback = "none",
              .meaning = "swept keys with one text per value, in the order of the values, which "
                         "stands for the value in the report"});
    walk.key({.key = "reference",
              .type = "table",
              .fallback = "none",
              .meaning = "changes to `[load.modulation]` that define an unmodulated case, which is "
                         "drawn as a dashed line and used for ratios"});
}

/// An element of `correlation` in [uncertain].
struct CorrelationKeys {};
template <class Walk, Is<CorrelationKeys> Keys>
void walk_fields(Walk& walk, Keys&) {
    walk.key({.key = "keys",
              .given = Given::required,
              .type = "pair of words",
              .meaning = "two uncertain keys"});
    walk.key({.key = "rank",
              .range = Range::inside(-1.0, 1.0),
              .given = Given::required,
              .type = "number",
              .meaning = "their rank correlation (Spearman), by a Gaussian copula"});
}

/// The options of [uncertain]; its other keys are uncertain keys with their distributions.
struct UncertainTableKeys {
    std::size_t samples = 2;
    sampling::Sampling sampling = sampling::Sampling::sobol;
    std::uint64_t seed = 1;
    sampling::Analysis analysis = sampling::Analysis::distribution;
    std::vector<CorrelationKeys> correlation = {};
};
template <class Walk, Is<UncertainTableKeys> Keys>
void walk_fields(Walk& walk, Keys& keys) {
    walk(keys.samples,
         {.key = "samples",
          .range = Range::between(2.0, 1e12),
          .given = Given::required,
          .meaning = "size of the sample. A larger sample contains all cases of a smaller one, "
                     "so a run in the same output folder extends it"});
    walk(keys.sampling,
         {.key = "sampling",
          .meaning = "`\"sobol\"`: Sobol sequence with a random shift; `\"latin-hypercube\"`: "
                     "nested, exact "
                     "at powers of two; `\"random\"`: independent numbers"});
    walk(keys.seed, {.key = "seed",
                     .range = Range::between(0.0, 9007199254740992.0),
                     .meaning = "seed of the random numbers; at most 2^53, exact as a number"});
    walk(keys.analysis,
         {.key = "analysis",
          .meaning =
              "`\"distribution\"`: one case per sample; `\"sobol-indices\"`: keys + 2 (Saltelli's "
              "design); `\"morris\"`: keys + 1 (radial design)"});
    walk.key({.key = "exceedance",
              .type = "table of numbers",
              .fallback = "none",
              .meaning = "columns with a threshold, whose probability of being exceeded `reduce` "
                         "estimates"});
    walk.each("uncertain.correlation", keys.correlation, {});
}

} // namespace shearwake::config
