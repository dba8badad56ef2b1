#include "config/read_path.hpp"

#include "base/error.hpp"
#include "config/points_file.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace shearwake {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
const Range lengths = Range::between(1e-3, 1e4);

struct Context {
    Reader& reader;
    const PathContext& path;
    LeastLength least;

    Range sizes() const { return least == LeastLength::none ? Range::between(0.0, 1e4) : lengths; }
};

Curve read_line(Context& c) {
    const std::size_t before = c.reader.findings().errors();
    const Line line = {.from_m = c.reader.point("from_mm"), .to_m = c.reader.point("to_mm")};
    if (!c.reader.empty() && c.reader.findings().errors() == before && c.reader.has("from_mm") &&
        c.reader.has("to_mm") && line.from_m == line.to_m && c.least == LeastLength::some)
        c.reader.error("to_mm", "is where the path starts: it has no length");
    return line;
}

Curve read_circle(Context& c) {
    Arc arc{.center_m = c.reader.point_or("center_mm", {}),
            .radius_m = c.reader.number("radius_mm", c.sizes()),
            .start_rad = c.reader.number_or("start_deg", 0.0, Range::any()),
            .sweep_rad = two_pi};
    if (c.reader.flag_or("clockwise", false)) arc.sweep_rad = -two_pi;
    return arc;
}

Curve read_arc(Context& c) {
    Arc arc{.center_m = c.reader.point_or("center_mm", {}),
            .radius_m = c.reader.number("radius_mm", c.sizes()),
            .start_rad = c.reader.number_or("start_deg", 0.0, Range::any()),
            .sweep_rad = c.reader.number("sweep_deg", Range::between(-360.0, 360.0))};
    if (arc.sweep_rad == 0.0) c.reader.error("sweep_deg", "is 0: the path has no length");
    return arc;
}

/// Straight lines through points of which none lies where the one before it does.
Curve checked_polyline(Context& c, const char* key, std::vector<Vec2> points_m, Ends ends) {
    const std::size_t least = ends == Ends::closed ? 3 : 2;
    std::string problem;
    if (points_m.size() < least)
        problem = fmt::format("must hold at least {} points, and holds {}", least, points_m.size());
    for (std::size_t i = 1; i < points_m.size() && problem.empty(); ++i)
        if (points_m[i] == points_m[i - 1])
            problem = fmt::format("has its points {} and {} at the same place", i, i + 1);
    if (problem.empty() && ends == Ends::closed && points_m.front() == points_m.back())
        problem = "ends where it starts: a closed path goes back by itself, leave the last point "
                  "out";
    if (problem.empty()) return Polyline(std::move(points_m), ends);
    c.reader.error(key, problem);
    return {};
}

Curve read_polyline(Context& c) {
    const bool closed = c.reader.flag_or("closed", false);
    if (!c.reader.has("points_mm")) c.reader.missing("points_mm");
    auto points_m = c.reader.find_points("points_mm");
    if (!points_m) return {};
    return checked_polyline(c, "points_mm", std::move(*points_m),
                            closed ? Ends::closed : Ends::open);
}

/// By its corners; or regular, standing on a side if not said otherwise.
Curve read_polygon(Context& c) {
    if (c.reader.has("corners_mm")) {
        auto points_m = c.reader.find_points("corners_mm");
        if (!points_m) return {};
        return checked_polyline(c, "corners_mm", std::move(*points_m), Ends::closed);
    }
    const Vec2 center_m = c.reader.point_or("center_mm", {});
    const int sides = read_count(c.reader, "sides", Range::between(3, 1000));
    const auto radius_m = c.reader.find_number("radius_mm", lengths);
    const auto side_m = c.reader.find_number("side_mm", lengths);
    if (c.reader.has("radius_mm") && c.reader.has("side_mm"))
        c.reader.error("side_mm", "and radius_mm are both given; one of them says it all");
    if (!c.reader.has("radius_mm") && !c.reader.has("side_mm")) c.reader.missing("radius_mm");
    const double start_rad =
        c.reader.number_or("start_deg", -0.25 * two_pi + 0.5 * two_pi / sides, Range::any());
    const double of_side_m = side_m.value_or(1.0) / (2.0 * std::sin(std::numbers::pi / sides));
    return regular_polygon(center_m, radius_m.value_or(of_side_m), sides, start_rad);
}

Curve read_lissajous(Context& c) {
    LissajousShape shape;
    shape.center_m = c.reader.point_or("center_mm", {});
    shape.amplitudes_m = c.reader.point("amplitudes_mm", lengths);
    shape.phase_rad = c.reader.number_or("phase_deg", 0.0, Range::any());
    const auto counts = c.reader.find_numbers("frequencies", Range::between(1, 50));
    if (!c.reader.has("frequencies")) c.reader.missing("frequencies");
    if (!counts) return {};
    const bool is_pair = counts->size() == 2 && counts->front() == std::floor(counts->front()) &&
                         counts->back() == std::floor(counts->back());
    if (!is_pair) {
        c.reader.error("frequencies", "must be two whole numbers [along x, along y]");
        return {};
    }
    shape.p = static_cast<int>(counts->front());
    shape.q = static_cast<int>(counts->back());
    if (const int common = std::gcd(shape.p, shape.q); common > 1) {
        c.reader.error("frequencies",
                       fmt::format("have the common factor {}, which would draw "
                                   "the figure {} times: [{}, {}] draws it once",
                                   common, common, shape.p / common, shape.q / common));
        return {};
    }
    return Lissajous(shape);
}

Curve read_csv(Context& c) {
    const bool closed = c.reader.flag_or("closed", false);
    if (!c.reader.has("file")) c.reader.missing("file");
    const auto name = c.reader.find_word("file");
    if (!name) return {};
    if (!c.path.load_text) {
        c.reader.error("file", "names a file, and no files are read here");
        return {};
    }
    try {
        PointsFile file = read_points(c.path.load_text(*name));
        if (file.problem.empty())
            return checked_polyline(c, "file", std::move(file.points_m),
                                    closed ? Ends::closed : Ends::open);
        c.reader.error("file", fmt::format("cannot be used: {}: {}", *name, file.problem));
    } catch (const UsageError& problem) {
        c.reader.error("file", fmt::format("cannot be used: {}", problem.what()));
    }
    return {};
}

struct Shape {
    const char* name;
    Curve (*read)(Context&);
};
constexpr std::array shapes = {
    Shape{"line", read_line},
    Shape{"circle", read_circle},
    Shape{"arc", read_arc},
    Shape{"polygon", read_polygon},
    Shape{"lissajous", read_lissajous},
    Shape{"polyline", read_polyline},
    Shape{"csv", read_csv},
};

} // namespace

int read_count(Reader& reader, std::string_view key, const Range& range) {
    const double count = reader.number(key, range);
    if (count != std::floor(count))
        reader.error(key, fmt::format("must be a whole number, and is {:.6g}", count));
    return static_cast<int>(std::max(count, range.least));
}

PathAndEnd read_path(Reader reader, const PathContext& context, LeastLength least) {
    static const std::array<std::string, 4> ends = {"off", "hold", "repeat", "back-and-forth"};
    PathAndEnd read;
    if (reader.empty()) return read;
    std::vector<std::string> names;
    for (const Shape& shape : shapes)
        names.emplace_back(shape.name);
    const auto name = reader.find_choice("shape", names);
    const auto end = reader.find_choice("at_end", ends);
    if (!name) { // its other keys are some shape's
        if (!reader.has("shape")) reader.error("shape", "is missing");
        return read;
    }
    Context c{reader, context, least};
    for (const Shape& shape : shapes)
        if (*name == shape.name) read.path = shape.read(c);
    reader.finish();
    read.end_is_given = end.has_value();
    read.at_end = is_closed(read.path) ? AtEnd::repeat : AtEnd::off;
    for (std::size_t i = 0; i < ends.size(); ++i)
        if (end == ends[i]) read.at_end = static_cast<AtEnd>(i);
    return read;
}

} // namespace shearwake
