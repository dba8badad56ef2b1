// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_path.hpp"

#include "base/error.hpp"
#include "base/python_module.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "config/document/job_keys.hpp"
#include "config/document/key_range.hpp"
#include "config/files/files.hpp"
#include "config/sections/read_fields.hpp"
#include "problem/load/array_field.hpp"
#include "problem/load/load_fields.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>
#include <sstream>

namespace shearwake::config {

namespace {

struct Context {
    Reader& reader;
    const PathContext& path;
    LeastLength least;
    std::optional<Rests> rests; // of a file of points
};

Curve read_shape(Context& c, const Line&) {
    const std::size_t before = c.reader.diagnostics().errors();
    Line line;
    read_fields(c.reader, line);
    if (!c.reader.empty() && c.reader.diagnostics().errors() == before && c.reader.has("from_mm") &&
        c.reader.has("to_mm") && line.from_m == line.to_m && c.least == LeastLength::some)
        c.reader.error("to_mm", "equals the start of the path, so the path has no length");
    return line;
}

double read_radius_m(Context& c) {
    return c.reader.number("radius_mm", c.least == LeastLength::some
                                            ? range_of<PathLengthKeys>("radius_mm")
                                            : range_of<Arc>("radius_mm"));
}

Curve read_shape(Context& c, const CircleKeys&) {
    Arc arc{.radius_m = read_radius_m(c), .sweep_rad = two_pi};
    read_fields(c.reader, arc, {.without = {"radius_mm", "sweep_deg"}});
    if (c.reader.find_flag("clockwise").value_or(false)) arc.sweep_rad = -two_pi;
    return arc;
}

Curve read_shape(Context& c, const Arc&) {
    Arc arc{.radius_m = read_radius_m(c)};
    read_fields(c.reader, arc, {.without = {"radius_mm"}});
    if (arc.sweep_rad == 0.0) c.reader.error("sweep_deg", "is 0, so the path has no length");
    return arc;
}

/// Straight lines through points, none of which equals the previous point.
Curve checked_polyline(Context& c, const char* key, std::vector<Vec2> points_m, Ends ends) {
    const std::size_t least = ends == Ends::closed ? 3 : 2;
    std::string problem;
    if (points_m.size() < least)
        problem =
            fmt::format("must contain at least {} points, but contains {}", least, points_m.size());
    for (std::size_t i = 1; i < points_m.size() && problem.empty(); ++i)
        if (points_m[i] == points_m[i - 1])
            problem = fmt::format("has points {} and {} at the same position", i, i + 1);
    if (problem.empty() && ends == Ends::closed && points_m.front() == points_m.back())
        problem = "ends where it starts; a closed path returns to its start by itself, so remove "
                  "the last point";
    if (problem.empty()) return Polyline(std::move(points_m), ends);
    c.reader.error(key, problem);
    return {};
}

Curve read_shape(Context& c, const Polyline&) {
    const bool closed = c.reader.find_flag("closed").value_or(false);
    if (!c.reader.has("points_mm")) c.reader.missing("points_mm");
    auto points_m = c.reader.find_points("points_mm");
    if (!points_m) return {};
    return checked_polyline(c, "points_mm", std::move(*points_m),
                            closed ? Ends::closed : Ends::open);
}

/// A polygon given by its corners, or a regular polygon, which stands on a side by default.
Curve read_shape(Context& c, const PolygonKeys&) {
    if (c.reader.has("corners_mm") || c.reader.has_misspelled("corners_mm")) {
        auto points_m = c.reader.find_points("corners_mm");
        if (!points_m) return {};
        return checked_polyline(c, "corners_mm", std::move(*points_m), Ends::closed);
    }
    const Vec2 center_m = c.reader.point_or("center_mm", {});
    const Range counts = range_of<PolygonKeys>("sides");
    if (!c.reader.has("sides")) c.reader.missing("sides");
    const int sides =
        static_cast<int>(find_integer(c.reader, "sides", counts).value_or(counts.least));
    const auto radius_m = c.reader.find_number("radius_mm", range_of<PolygonKeys>("radius_mm"));
    const auto side_m = c.reader.find_number("side_mm", range_of<PolygonKeys>("side_mm"));
    if (c.reader.has("radius_mm") && c.reader.has("side_mm"))
        c.reader.conflict("side_mm",
                          "and radius_mm are both given; remove one of them from the job");
    if (!c.reader.has("radius_mm") && !c.reader.has("side_mm")) c.reader.missing("radius_mm");
    const double start_rad =
        c.reader.number_or("start_deg", -0.25 * two_pi + 0.5 * two_pi / sides, Range::any());
    const double of_side_m = side_m.value_or(1.0) / (2.0 * std::sin(std::numbers::pi / sides));
    return regular_polygon(center_m, radius_m.value_or(of_side_m), sides, start_rad);
}

Curve read_shape(Context& c, const Lissajous&) {
    Lissajous curve = Example<Lissajous>::make();
    read_fields(c.reader, curve);
    LissajousShape shape = curve.shape();
    if (!c.reader.has("frequencies")) c.reader.missing("frequencies");
    const auto counts = find_integer_pair(
        c.reader, "frequencies", range_of<Lissajous>("frequencies"), " [along x, along y]");
    if (!counts) return {};
    shape.p = counts->front();
    shape.q = counts->back();
    if (const int common = std::gcd(shape.p, shape.q); common > 1) {
        c.reader.error("frequencies",
                       fmt::format("have the common factor {}, so the figure would be drawn {} "
                                   "times; [{}, {}] draws it once",
                                   common, common, shape.p / common, shape.q / common));
        return {};
    }
    return Lissajous(shape);
}

/// A path through the points of a file that states how long the focus rests at each of them.
/// Points that are equal to the previous one prolong its rest.
Curve path_with_rests(Context& c, const PointsFile& file, Ends ends) {
    std::vector<Vec2> places_m;
    std::vector<std::size_t> place;
    Rests rests{.levels = file.levels};
    for (std::size_t i = 0; i < file.points_m.size(); ++i) {
        if (places_m.empty() || places_m.back() != file.points_m[i])
            places_m.push_back(file.points_m[i]);
        place.push_back(places_m.size() - 1);
        rests.ends_s.push_back((i == 0 ? 0.0 : rests.ends_s.back()) + file.rests_s[i]);
    }
    if (ends == Ends::closed && places_m.size() > 1 && places_m.front() == places_m.back()) {
        places_m.pop_back(); // the path returns there by itself
        for (std::size_t& of : place)
            of %= places_m.size();
    }
    Curve path = checked_polyline(c, "file", std::move(places_m), ends);
    const auto* line = std::get_if<Polyline>(&path.shape);
    if (!line) return path;
    for (const std::size_t of : place)
        rests.arcs_m.push_back(line->arc_m(of));
    c.rests = std::move(rests);
    return path;
}

Curve read_shape(Context& c, const PathFileKeys&) {
    const bool closed = c.reader.find_flag("closed").value_or(false);
    if (!c.reader.has("file")) c.reader.missing("file");
    const auto text = load_named(c.reader, "file", c.path.load_text);
    if (!text) return {};
    PointsFile file = read_points(*text, Columns::rests);
    const Ends ends = closed ? Ends::closed : Ends::open;
    if (file.problem.empty() && !file.rests_s.empty()) return path_with_rests(c, file, ends);
    if (file.problem.empty()) return checked_polyline(c, "file", std::move(file.points_m), ends);
    c.reader.error("file",
                   fmt::format("cannot be used: {}: {}", c.reader.word("file"), file.problem));
    return {};
}

/// In the order of path_words.
using Shapes = std::variant<Line, CircleKeys, Arc, PolygonKeys, Lissajous, Polyline, PathFileKeys>;
static_assert([]<class... S>(std::type_identity<std::variant<S...>>) {
    return (std::is_constructible_v<Shapes, S> && ...);
}(std::type_identity<decltype(Curve::shape)>{}));

/// A pass through the phases of an array per frame, after the number of its pistons.
PointsFile read_frames(const std::string& text, ArrayFootprint* array) {
    if (!array || array->update_rate_Hz == 0.0)
        return {.problem = "has phases per frame, which need footprint.shape = \"array\" with "
                           "update_rate_kHz, the rate of the frames, and no foci_mm"};
    std::istringstream words(text.substr(text.find_first_of("0123456789")));
    std::ptrdiff_t width = 0;
    words >> width;
    const std::ptrdiff_t pistons = array->columns * array->rows - std::ssize(array->missing);
    if (width != pistons)
        return {.problem = fmt::format("has {} phases per frame, but the array has {} pistons",
                                       width, pistons)};
    const auto frames = std::make_shared<PhaseFrames>();
    frames->content_hash = hex(stable_hash(text));
    const BoardOrder order = board_order(*array);
    PhaseFrame frame{{}, std::vector<std::complex<double>>(order.size())};
    for (; words >> std::ws && !words.eof(); frame.place_m.x += 1.0) {
        for (const auto& [place, piston] : order) {
            double phase_rad = 0.0;
            words >> phase_rad;
            frame.drives[piston] = std::polar(1.0, phase_rad);
        }
        frames->all.push_back(frame);
    }
    array->frames = frames;
    ArrayFootprint wide = *array; // as its pistons
    wide.reach_m = 0.5 * wide.pitch_m * static_cast<double>(std::max(wide.columns, wide.rows));
    const ArrayField field(wide, 0.0);
    PointsFile file;
    for (PhaseFrame& shown : frames->all) { // selected by its number until its place is known
        const Patch patch = field.pattern(wide.center_m, {&shown.place_m, 1});
        const auto most = std::ranges::max_element(patch.values) - patch.values.begin();
        const Vec2 steps = {static_cast<double>(most / patch.side),
                            static_cast<double>(most % patch.side)};
        // 1 pm distinguishes frames with one place.
        shown.place_m = patch.origin_m + patch.spacing_m * steps + 1e-12 * shown.place_m;
        file.points_m.push_back(shown.place_m);
    }
    file.rests_s.assign(file.points_m.size(), 1.0 / std::exchange(array->update_rate_Hz, 0.0));
    return file;
}

} // namespace

void read_played(Reader& reader, const PathContext& context, Footprint& footprint,
                 Modulation& modulation) {
    const std::string end = read_optional_word(reader, field_of<Modulation>("at_end"));
    const AtEnd at_end = end == "off" ? AtEnd::off : end == "hold" ? AtEnd::hold : AtEnd::repeat;
    const Vec2 place_m = reader.point_or("position_mm", {});
    if (!reader.has("file")) reader.missing("file");
    const auto text = load_named(reader, "file", context.load_text, played_file);
    if (!text) return;
    std::istringstream lines(*text);
    std::string kind;
    std::getline(lines, kind);
    for (std::string line; std::getline(lines, line) && line.starts_with("# ");)
        reader.diagnostics().warning(reader.place("file"), reader.full("file") + line.substr(1));
    auto* array = reader.has("foci_mm") ? nullptr : std::get_if<ArrayFootprint>(&footprint);
    PointsFile file = kind.starts_with("# phases") ? read_frames(*text, array)
                                                   : read_points(*text, Columns::rests);
    if (!file.problem.empty()) return reader.error("file", file.problem);
    if (kind == "# envelope") {
        if (at_end == AtEnd::off) file.levels.push_back(0.0);
        modulation.envelope.gains.push_back(
            SampledGain{file.levels, file.rests_s.front(), at_end == AtEnd::repeat});
        return modulation.trajectory.parts.push_back(Hold{place_m});
    }
    Context c{reader, context, LeastLength::some, {}};
    Travel travel{.path = path_with_rests(c, file, Ends::open), .at_end = at_end};
    travel.motion = c.rests.value_or(Rests{});
    modulation.trajectory.parts.push_back(travel);
}

PathAndEnd read_path(Reader reader, const PathContext& context, LeastLength least) {
    constexpr auto names_of_ends = names_of(std::type_identity<AtEnd>{});
    const std::vector<std::string> ends(names_of_ends.begin(), names_of_ends.end());
    PathAndEnd read;
    if (reader.empty()) return read;
    const auto name = reader.find_choice("shape", alternative_names<Shapes>());
    const auto end = reader.find_choice("at_end", ends);
    if (!name) { // its other keys belong to some shape
        reader.report_missing("shape");
        return read;
    }
    Context c{reader, context, least, {}};
    for_each_alternative(std::type_identity<Shapes>{}, [&](const auto& shape) {
        if (*name == shape.name) read.path = read_shape(c, shape);
    });
    read.rests = std::move(c.rests);
    reader.finish();
    read.end_is_given = end.has_value();
    read.at_end = is_closed(read.path) ? AtEnd::repeat : AtEnd::off;
    for (std::size_t i = 0; i < ends.size(); ++i)
        if (end == ends[i]) read.at_end = static_cast<AtEnd>(i);
    return read;
}

} // namespace shearwake::config
