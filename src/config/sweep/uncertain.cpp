// SPDX-License-Identifier: BSD-3-Clause
#include "config/sweep/uncertain.hpp"

#include "base/constants.hpp"
#include "base/text.hpp"
#include "config/document/reader.hpp"
#include "config/sweep/axis_values.hpp"
#include "config/sweep/uncertain_keys.hpp"
#include "sampling/copula.hpp"
#include "sampling/design.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

constexpr std::array options = {"samples", "sampling",    "analysis",
                                "seed",    "correlation", "exceedance"};
constexpr std::size_t most_uncertain_keys = 30;
constexpr double largest_seed = 9007199254740992.0; // 2^53, exact as a number

bool is_option(const std::string& key) {
    return std::ranges::find(options, key) != options.end();
}

double whole_number(Reader& reader, std::string_view key, double value) {
    if (value == std::floor(value)) return value;
    reader.error(key, fmt::format("must be a whole number, but is {}", value));
    return 2.0;
}

/// The keys with their distributions.
struct UncertainKeys {
    Axis axis; // without values
    std::vector<sampling::Distribution> distributions;
};

UncertainKeys read_keys(const TableNode& table, const Sweep& sweep, const FileLoaders& files,
                        DiagnosticList& diagnostics) {
    UncertainKeys found;
    for (const Entry& entry : table.entries) {
        if (is_option(entry.key)) continue;
        const auto path = case_path(entry, "uncertain", diagnostics);
        if (!path) continue;
        if (sweep.holds(entry.key)) {
            diagnostics.error(entry.key_at, fmt::format("uncertain: {} is also swept; remove it "
                                                        "from one of the two tables",
                                                        entry.key));
            continue;
        }
        if (!std::holds_alternative<TableNode>(entry.value->value)) {
            diagnostics.error(entry.value->at,
                              fmt::format("uncertain: {} requires a distribution, for example {{ "
                                          "distribution = \"uniform\", min = 1.0, max = 2.0 }}",
                                          entry.key));
            continue;
        }
        const Reader reader(entry.value, fmt::format("uncertain.\"{}\"", entry.key), diagnostics);
        const auto distribution = read_distribution(reader, entry.key, files);
        if (!distribution) continue;
        found.axis.keys.push_back({entry.key, *path, entry.key_at, {}});
        found.distributions.push_back(*distribution);
    }
    return found;
}

sampling::Copula read_correlations(Reader& reader, const UncertainKeys& keys,
                                   const std::string& analysis) {
    sampling::Copula copula(keys.axis.keys.size());
    const auto place_of_key = [&](const std::string& key) {
        const auto found = std::ranges::find(keys.axis.keys, key, &SweptKey::key);
        return static_cast<std::size_t>(found - keys.axis.keys.begin());
    };
    if (!reader.has("correlation")) return copula;
    if (analysis != sampling::analysis_names().front())
        reader.error("correlation", "is not possible with this analysis, whose indices are "
                                    "defined for independent keys");
    for (Reader& pair : reader.tables("correlation")) {
        const auto names = pair.find_words("keys");
        const double rank = pair.number("rank", Range::inside(-1.0, 1.0));
        pair.finish();
        const std::size_t end = keys.axis.keys.size();
        if (!names || names->size() != 2 || place_of_key(names->front()) == end ||
            place_of_key(names->back()) == end || names->front() == names->back())
            pair.error("keys", "must name two different uncertain keys");
        else
            copula.correlate(place_of_key(names->front()), place_of_key(names->back()), rank);
    }
    if (!copula.exists())
        reader.error("correlation", "contradicts itself: no numbers have these correlations (the "
                                    "matrix is not positive definite)");
    return copula;
}

std::vector<Threshold> read_thresholds(Reader& reader) {
    std::vector<Threshold> thresholds;
    Reader table = reader.optional_table("exceedance");
    for (const std::string& column : table.keys()) {
        const NodePtr node = table.node(column);
        double value = not_a_number;
        if (const auto* integer = std::get_if<std::int64_t>(&node->value))
            value = static_cast<double>(*integer);
        else if (const auto* number = std::get_if<double>(&node->value))
            value = *number;
        if (std::isfinite(value))
            thresholds.push_back({column, value});
        else
            table.error(column, "must be a finite number, the threshold of this column");
    }
    return thresholds;
}

/// Whether the sample and the sweep together have a supported number of cases.
bool fits(const UncertainPlan& plan, const Sweep& sweep, Reader& reader) {
    double cases = static_cast<double>(plan.samples) *
                   static_cast<double>(sampling::rows_per_sample(sampling::design_of(plan)));
    for (const Axis& axis : sweep.axes)
        cases *= static_cast<double>(axis.size());
    if (cases <= static_cast<double>(most_cases)) return true;
    reader.error("samples", fmt::format("results in {:.0f} cases; at most {} are supported", cases,
                                        most_cases));
    return false;
}

/// Numbers with nine digits, as tables contain them: the last digits of a quantile may differ
/// between libraries, and ids must not.
double rounded_sample(double value) {
    return std::stod(fmt::format("{:.9g}", value));
}

void fill(UncertainKeys& keys, const sampling::Points& points) {
    for (std::size_t k = 0; k < keys.axis.keys.size(); ++k) {
        SweptKey& key = keys.axis.keys[k];
        for (const std::vector<double>& point : points)
            key.values.push_back(make_node(
                rounded_sample(sampling::quantile(keys.distributions[k], point[k])), key.at));
    }
}

void read_options(Reader& reader, UncertainPlan& plan) {
    plan.samples = static_cast<std::size_t>(
        whole_number(reader, "samples", reader.number("samples", Range::between(2.0, 1e12))));
    const auto &samplings = sampling::sampling_names(), &analyses = sampling::analysis_names();
    plan.sampling = reader.choice_or("sampling", samplings.front(), samplings);
    plan.analysis = reader.choice_or("analysis", analyses.front(), analyses);
    plan.seed = static_cast<std::uint64_t>(whole_number(
        reader, "seed", reader.number_or("seed", 1.0, Range::between(0.0, largest_seed))));
    plan.exceedance = read_thresholds(reader);
}

} // namespace

NodePtr flattened_uncertain(const NodePtr& uncertain) {
    return flattened(uncertain, [](const std::string& key, const Node& node) {
        const auto& table = std::get<TableNode>(node.value);
        return is_option(key) || table.entries.empty() || table.find("distribution") ||
               table.find("preset");
    });
}

std::vector<UncertainKey> uncertain_keys(const NodePtr& job, const FileLoaders& files,
                                         DiagnosticList& diagnostics) {
    const NodePtr given = find(job, {{"uncertain"}});
    if (!given || !std::holds_alternative<TableNode>(given->value)) return {};
    const NodePtr table = flattened_uncertain(given);
    const UncertainKeys found =
        read_keys(std::get<TableNode>(table->value), Sweep{}, files, diagnostics);
    std::vector<UncertainKey> keys;
    for (std::size_t i = 0; i < found.axis.keys.size(); ++i)
        keys.push_back({found.axis.keys[i].key, found.distributions[i]});
    return keys;
}

std::optional<UncertainPlan> read_uncertain(const NodePtr& uncertain, Sweep& sweep,
                                            const FileLoaders& files, DiagnosticList& diagnostics) {
    const std::size_t before = diagnostics.errors();
    const auto* table = std::get_if<TableNode>(&uncertain->value);
    if (!table) {
        diagnostics.error(uncertain->at, "uncertain must be a table");
        return std::nullopt;
    }
    if (table->entries.empty()) return std::nullopt;
    UncertainKeys keys = read_keys(*table, sweep, files, diagnostics);
    UncertainPlan plan;
    for (const SweptKey& key : keys.axis.keys)
        plan.keys.push_back(key.key);
    Reader reader(uncertain, "uncertain", diagnostics);
    std::vector<std::string> names;
    for (const std::string& name : reader.keys())
        if (!is_option(name)) names.push_back(name);
    reader.allow(names);
    read_options(reader, plan);
    const sampling::Copula copula = read_correlations(reader, keys, plan.analysis);
    reader.finish();
    if (names.empty() || names.size() > most_uncertain_keys)
        diagnostics.error(uncertain->at,
                          fmt::format("uncertain has {} keys with a distribution; between 1 and "
                                      "{} are supported",
                                      names.size(), most_uncertain_keys));
    if (diagnostics.errors() != before || !sweep.sound || !fits(plan, sweep, reader))
        return std::nullopt;
    sampling::Points points = sampling::design_points(sampling::design_of(plan));
    if (reader.has("correlation")) copula.apply(points);
    fill(keys, points);
    sweep.sampled_axis = sweep.axes.size();
    sweep.axes.push_back(std::move(keys.axis));
    return plan;
}

} // namespace shearwake::config
