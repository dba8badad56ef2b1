// SPDX-License-Identifier: BSD-3-Clause
#include "studies/converge/convergence.hpp"

#include "base/units.hpp"
#include "measures/measure_table.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake::converge {
namespace {

double value_in(const std::map<std::string, Values>& all, const std::string& id,
                const std::string& column) {
    const auto row = all.find(id);
    if (row == all.end()) return not_a_number;
    const auto cell = row->second.find(column);
    return cell == row->second.end() ? not_a_number : cell->second;
}

/// Errors of a single frame vary irregularly with the position of the samples, and changes may be
/// small by chance. Roache's grid convergence index (1994) has a factor of 1.25 to 3 for this.
constexpr double safety_factor = 1.5;

ColumnChange change_of(const StudiedCase& studied, const std::string& column, double value,
                       const std::map<std::string, Values>& values) {
    ColumnChange change{.column = column, .value = value, .changes = {}};
    for (std::size_t i = 0; i < studied.refinements.size(); ++i) {
        const double difference = value_in(values, studied.refined_ids[i], column) - value;
        change.changes.push_back(difference);
        change.error += safety_factor * estimated_error(difference, studied.refinements[i]);
    }
    return change;
}

/// A peak is the largest of all samples: both grids may miss it by the same amount.
bool has_estimate(const std::string& column) {
    return !measures::counts_samples(column) && !column.starts_with("peak_um") &&
           !column.starts_with("felt_peak_");
}

/// Errors of levels are those of the amplitude, which do not depend on where 0 dB is.
double relative_error(const ColumnChange& change) {
    return change.column.ends_with("_dB") ? std::pow(10.0, change.error / 20.0) - 1.0
                                          : change.error / std::abs(change.value);
}

std::string signed_number(double value) {
    return std::isnan(value) ? "" : fmt::format("{:+.2g}", value);
}

std::string order_words(const Refinement& r) {
    return r.order ? fmt::format("order {:g}", *r.order) : "no order: the change is the estimate";
}

} // namespace

std::vector<CaseChange> changes_of(const RefinedPlan& refined,
                                   const std::map<std::string, Values>& values) {
    std::vector<CaseChange> all;
    for (const StudiedCase& studied : refined.cases) {
        CaseChange change{.studied = &studied, .columns = {}};
        change.is_complete = values.contains(studied.base_id) &&
                             std::ranges::all_of(studied.refined_ids, [&](const std::string& id) {
                                 return values.contains(id);
                             });
        if (const auto base = values.find(studied.base_id); base != values.end())
            for (const auto& [column, value] : base->second)
                if (!std::isnan(value) && has_estimate(column))
                    change.columns.push_back(change_of(studied, column, value, values));
        all.push_back(std::move(change));
    }
    return all;
}

std::string json_text(const std::string& job, const std::vector<CaseChange>& changes) {
    using nlohmann::ordered_json;
    ordered_json cases = ordered_json::array();
    for (const CaseChange& c : changes) {
        ordered_json refinements = ordered_json::array(), columns = ordered_json::object(),
                     settings = ordered_json::object();
        for (std::size_t i = 0; i < c.studied->refinements.size(); ++i) {
            const Refinement& r = c.studied->refinements[i];
            refinements.push_back({{"name", r.name},
                                   {"change", r.change},
                                   {"id", c.studied->refined_ids[i]},
                                   {"ratio", r.ratio},
                                   {"order", r.order ? ordered_json(*r.order) : nullptr}});
        }
        for (const ColumnChange& column : c.columns) {
            ordered_json by_name = ordered_json::object();
            for (std::size_t i = 0; i < column.changes.size(); ++i)
                by_name[c.studied->refinements[i].name] = column.changes[i]; // NaN: null
            columns[column.column] = {
                {"value", column.value}, {"changes", by_name}, {"error", column.error}};
        }
        for (const Setting& s : c.studied->planned->settings)
            std::visit([&](const auto& v) { settings[s.key] = v; }, s.value);
        cases.push_back({{"id", c.studied->planned->id},
                         {"settings", settings},
                         {"is_reference", c.studied->planned->is_reference},
                         {"complete", c.is_complete},
                         {"valid", c.is_valid},
                         {"refinements", refinements},
                         {"columns", columns}});
    }
    return ordered_json({{"schema", 1}, {"job", job}, {"cases", cases}}).dump(1) + "\n";
}

std::string markdown_text(const std::vector<CaseChange>& changes,
                          const std::vector<std::string>& shown) {
    std::string text;
    for (const CaseChange& c : changes) {
        const PlannedCase& planned = *c.studied->planned;
        text +=
            fmt::format("{}## {}{}{}{}{}\n\n", text.empty() ? "" : "\n", planned.id,
                        planned.is_reference ? ", reference" : "", c.is_valid ? "" : ", not valid",
                        planned.settings.empty() ? "" : ": ", settings_text(planned.settings));
        for (const Refinement& r : c.studied->refinements)
            text += fmt::format("* {}: {} ({})\n", r.name, r.change, order_words(r));
        text += "\n| column | value |";
        std::string rule = "| --- | ---: |";
        for (const Refinement& r : c.studied->refinements) {
            text += fmt::format(" change: {} |", r.name);
            rule += " ---: |";
        }
        text += " estimated error | relative |\n" + rule + " ---: | ---: |\n";
        for (const std::string& name : shown)
            for (const ColumnChange& column : c.columns) {
                if (column.column != name) continue;
                text += fmt::format("| {} | {:.5g} |", name, column.value);
                for (const double change : column.changes)
                    text += " " + signed_number(change) + " |";
                const bool known = !std::isnan(column.error);
                text +=
                    fmt::format(" {} | {} |\n", known ? fmt::format("{:.2g}", column.error) : "",
                                known && (column.value != 0.0 || column.column.ends_with("_dB"))
                                    ? fmt::format("{:.2g} %", 100.0 * relative_error(column))
                                    : "");
            }
    }
    return text;
}

} // namespace shearwake::converge
