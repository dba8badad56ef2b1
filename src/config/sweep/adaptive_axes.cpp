// SPDX-License-Identifier: BSD-3-Clause
#include "config/sweep/adaptive_axes.hpp"

#include "config/document/reader.hpp"

#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

constexpr double most_points = 10000.0;
/// Tables have nine digits, so that points much closer than this share of the interval coincide.
constexpr double least_share = 1e-6;
/// The default of smallest_step as a share of the interval.
constexpr double default_share = 1e-3;

/// Both ends of the interval, ascending.
void read_ends(Reader& reader, const char* key, AdaptiveAxis& axis) {
    if (!reader.has(key)) return reader.missing(key);
    const auto ends = reader.find_numbers(key, Range::any());
    if (!ends) return;
    if (ends->size() == 2 && ends->front() < ends->back()) {
        axis.first = ends->front();
        axis.last = ends->back();
    } else {
        reader.error(key, "must be two ascending numbers, [first, last]");
    }
}

std::size_t read_count(Reader& reader, const char* key, double fallback, double least) {
    const double count = reader.number_or(key, fallback, Range::between(least, most_points));
    if (count != std::floor(count))
        reader.error(key, fmt::format("must be a whole number, but is {}", count));
    return static_cast<std::size_t>(count);
}

void read_goal(Reader& reader, AdaptiveAxis& axis) {
    using Goal = AdaptiveAxis::Goal;
    if (reader.has("refine")) return read_ends(reader, "refine", axis);
    const std::vector<std::string> goals = {name_of(Goal::maximum), name_of(Goal::minimum),
                                            name_of(Goal::crossing)};
    const std::string goal = reader.choice("find", goals);
    for (const Goal known : {Goal::maximum, Goal::minimum, Goal::crossing})
        if (goal == name_of(known)) axis.goal = known;
    read_ends(reader, "in", axis);
    if (axis.goal != Goal::crossing) return;
    const auto level = reader.find_number("level", Range::any());
    axis.has_level = level.has_value();
    axis.level = level.value_or(0.0);
}

void read_resolution(Reader& reader, AdaptiveAxis& axis) {
    const double length = axis.last - axis.first;
    axis.tolerance = reader.number("tolerance", Range::above(0.0));
    if (axis.goal == AdaptiveAxis::Goal::refine)
        axis.smallest_step = reader.number_or("smallest_step", default_share * length,
                                              Range::at_least(least_share * length));
    else if (axis.tolerance < least_share * length)
        reader.error("tolerance",
                     fmt::format("must be at least {:g}, a millionth of the interval, but is {:g}",
                                 least_share * length, axis.tolerance));
}

} // namespace

bool is_adaptive(const Node& node) {
    const auto* table = std::get_if<TableNode>(&node.value);
    return table && (table->find("refine") || table->find("find"));
}

std::optional<AdaptiveAxis> read_adaptive_axis(const std::string& key, const NodePtr& node,
                                               DiagnosticList& diagnostics) {
    const std::size_t before = diagnostics.errors();
    Reader reader(node, fmt::format("sweep.\"{}\"", key), diagnostics);
    AdaptiveAxis axis{.key = key};
    read_goal(reader, axis);
    axis.column = reader.word("column");
    read_resolution(reader, axis);
    axis.initial = read_count(reader, "initial", 9.0, 3.0);
    axis.most = read_count(reader, "most", 200.0, 3.0);
    reader.finish();
    if (diagnostics.errors() != before) return std::nullopt;
    return axis;
}

} // namespace shearwake::config
