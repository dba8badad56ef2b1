// SPDX-License-Identifier: BSD-3-Clause
#include "config/sweep/sweep.hpp"

#include "base/text.hpp"
#include "config/document/job_keys.hpp"
#include "config/document/reader.hpp"
#include "config/sections/read_fields.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {

namespace {

const std::array<std::string, 3> generators = {"linspace", "logspace", "range"};

std::optional<double> finite_number(const Node& node) {
    const auto number = as_number(node);
    return number && std::isfinite(*number) ? number : std::nullopt;
}

std::optional<std::array<double, 3>> three_numbers(const Node& node) {
    const auto* list = std::get_if<ListNode>(&node.value);
    if (!list || list->size() != 3) return std::nullopt;
    std::array<double, 3> numbers{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto number = finite_number(*(*list)[i]);
        if (!number) return std::nullopt;
        numbers[i] = *number;
    }
    return numbers;
}

/// Rounds to twelve digits: the third of ten values from 0.1 to 1 is 0.3 and not
/// 0.30000000000000004.
double rounded(double value) {
    return std::stod(fmt::format("{:.12g}", value));
}

/// The numbers of a generator, or the reason why it was rejected.
struct Generated {
    std::vector<double> values;
    std::string problem;
};

Generated spaced(double a, double b, double n, bool logarithmic) {
    const Range counts = range_of<AxisKeys>("linspace");
    if (!counts.contains(n) || n != std::floor(n))
        return {{},
                fmt::format("requires a count from {} to {} as its third number, which is {:.6g}",
                            counts.least, counts.most, n)};
    if (logarithmic && !(a > 0.0 && b > 0.0)) return {{}, "requires both ends to be above 0"};
    Generated out;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
        const double share = static_cast<double>(i) / (n - 1.0);
        out.values.push_back(
            rounded(logarithmic ? a * std::pow(b / a, share) : a + (b - a) * share));
    }
    out.values.front() = a;
    out.values.back() = b;
    return out;
}

Generated stepped(double start, double stop, double step) {
    if (step == 0.0 || (stop - start) / step < 0.0)
        return {{}, "requires a step that leads from its first number to its second"};
    const double steps = std::floor((stop - start) / step * (1.0 + 1e-12) + 1e-9);
    if (!(steps < static_cast<double>(most_cases)))
        return {{},
                fmt::format("has {} values; at most {} are supported",
                            steps < 1e15 ? fmt::format("{:.0f}", steps + 1.0) : "too many",
                            most_cases)};
    Generated out;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(steps); ++i)
        out.values.push_back(rounded(start + static_cast<double>(i) * step));
    return out;
}

std::vector<NodePtr> generate(const std::string& key, const Node& node,
                              DiagnosticList& diagnostics) {
    const Entry& entry = std::get<TableNode>(node.value).entries.front();
    const auto numbers = three_numbers(*entry.value);
    const bool is_range = entry.key == "range";
    if (!numbers) {
        diagnostics.error(entry.value->at,
                          fmt::format("{}: {} requires three numbers, {}", key, entry.key,
                                      is_range ? "[start, stop, step]" : "[first, last, count]"));
        return {};
    }
    const auto [a, b, c] = *numbers;
    const Generated out = is_range ? stepped(a, b, c) : spaced(a, b, c, entry.key == "logspace");
    if (!out.problem.empty())
        diagnostics.error(entry.value->at, fmt::format("{}: {} {}", key, entry.key, out.problem));
    std::vector<NodePtr> values;
    for (const double value : out.values)
        values.push_back(make_node(value, entry.value->at));
    return values;
}

} // namespace

bool is_generator(const Node& node) {
    const auto* table = std::get_if<TableNode>(&node.value);
    if (!table || table->entries.size() != 1) return false;
    for (const std::string& name : generators)
        if (table->entries.front().key == name) return true;
    return false;
}

std::vector<NodePtr> axis_values(const std::string& key, const NodePtr& node,
                                 DiagnosticList& diagnostics) {
    if (is_generator(*node)) return generate(key, *node, diagnostics);
    const auto* list = std::get_if<ListNode>(&node->value);
    if (!list) {
        diagnostics.error(
            node->at, fmt::format("{} must be a list of values, or a table with one of {}; it is "
                                  "{}",
                                  key, quoted_list(generators), kind_name(*node)));
        return {};
    }
    if (list->empty())
        diagnostics.error(node->at,
                          fmt::format("{} has no values; an axis must have at least one", key));
    return *list;
}

namespace {

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
    const bool refines = axis.goal == AdaptiveAxis::Goal::refine;
    axis.tolerance = reader.number("tolerance", range_of<AxisKeys>("tolerance"));
    if (refines)
        axis.smallest_step = reader.number_or("smallest_step", default_share * length,
                                              range_of<AxisKeys>("smallest_step"));
    const double step = refines ? axis.smallest_step : axis.tolerance;
    if (step < least_share * length)
        reader.error(refines ? "smallest_step" : "tolerance",
                     fmt::format("must be at least {:g}, a millionth of the interval, but is {:g}",
                                 least_share * length, step));
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
    AxisKeys points;
    read_fields(reader, points);
    axis.initial = points.initial;
    axis.most = points.most;
    reader.finish();
    if (diagnostics.errors() != before) return std::nullopt;
    return axis;
}

} // namespace shearwake::config
