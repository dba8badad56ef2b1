// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/tolerance.hpp"

#include "base/error.hpp"
#include "config/document/tree.hpp"
#include "measures/measure_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::reduce {
namespace {

constexpr std::string_view all_others = "*";

void put(Tolerances& tolerances, const std::string& column, const Tolerance& tolerance) {
    if (column == all_others)
        tolerances.others = tolerance;
    else
        tolerances.named[column] = tolerance;
}

/// A number of at least 0, or nothing and a diagnostic.
std::optional<double> amount(const config::Entry& entry, config::DiagnosticList& diagnostics) {
    double value = -1.0;
    if (const auto* whole = std::get_if<std::int64_t>(&entry.value->value))
        value = static_cast<double>(*whole);
    else if (const auto* number = std::get_if<double>(&entry.value->value))
        value = *number;
    if (std::isfinite(value) && value >= 0.0) return value;
    diagnostics.error(entry.value->at, fmt::format("{} must be a number of at least 0, but is {}",
                                                   config::excerpt(entry.key),
                                                   config::excerpt(config::render(*entry.value))));
    return std::nullopt;
}

void read_table(const config::Entry& column, const config::TableNode& table, Tolerances& tolerances,
                config::DiagnosticList& diagnostics) {
    Tolerance tolerance = tolerances.of(column.key);
    for (const config::Entry& entry : table.entries) {
        if (entry.key == "relative")
            tolerance.relative = amount(entry, diagnostics).value_or(0.0);
        else if (entry.key == "absolute")
            tolerance.absolute = amount(entry, diagnostics);
        else
            diagnostics.error(entry.key_at,
                              fmt::format("{}.{} is unknown; the keys are relative and absolute",
                                          config::excerpt(column.key), config::excerpt(entry.key)));
    }
    put(tolerances, column.key, tolerance);
}

void read_columns(const config::Entry& section, Tolerances& tolerances,
                  config::DiagnosticList& diagnostics) {
    const auto* table = std::get_if<config::TableNode>(&section.value->value);
    if (!table) {
        diagnostics.error(
            section.value->at,
            "tolerance must be a table: [tolerance], followed by lines COLUMN = RELATIVE");
        return;
    }
    for (const config::Entry& entry : table->entries)
        if (const auto* parts = std::get_if<config::TableNode>(&entry.value->value))
            read_table(entry, *parts, tolerances, diagnostics);
        else if (const auto relative = amount(entry, diagnostics))
            put(tolerances, entry.key, {.relative = *relative});
}

void read_ignored(const config::Entry& entry, Tolerances& tolerances,
                  config::DiagnosticList& diagnostics) {
    const auto* list = std::get_if<config::ListNode>(&entry.value->value);
    bool words = list != nullptr;
    for (std::size_t i = 0; words && i < list->size(); ++i) {
        const auto* word = std::get_if<std::string>(&(*list)[i]->value);
        words = word != nullptr;
        if (words) tolerances.ignored.push_back(*word);
    }
    if (!words)
        diagnostics.error(entry.value->at,
                          "ignore must be a list of columns: ignore = [\"peak_um\"]");
}

} // namespace

Tolerance default_tolerance(std::string_view column) {
    const measures::Measure* measure = measures::find_measure(column);
    return {.relative = measure ? measure->tolerance : measures::Measure{}.tolerance};
}

bool is_never_compared(std::string_view column) {
    return column == "wall_s" || column == "host" || column == "hosts" || column == "note";
}

Tolerance Tolerances::of(std::string_view column) const {
    const auto found = named.find(column);
    if (found != named.end()) return found->second;
    return others.value_or(default_tolerance(column));
}

bool Tolerances::ignores(std::string_view column) const {
    return is_never_compared(column) ||
           std::find(ignored.begin(), ignored.end(), column) != ignored.end();
}

Tolerances read_tolerances(std::string_view text, const std::string& file_name) {
    config::DiagnosticList diagnostics;
    Tolerances tolerances;
    const config::NodePtr root = config::parse_toml(text, file_name, diagnostics);
    if (root) {
        for (const config::Entry& entry : std::get<config::TableNode>(root->value).entries) {
            if (entry.key == "tolerance")
                read_columns(entry, tolerances, diagnostics);
            else if (entry.key == "ignore")
                read_ignored(entry, tolerances, diagnostics);
            else
                diagnostics.error(entry.key_at,
                                  fmt::format("{} is unknown; a file of tolerances contains "
                                              "[tolerance] and, above it, ignore = [...]",
                                              config::excerpt(entry.key)));
        }
    }
    if (diagnostics.errors() == 0) return tolerances;
    std::string message;
    for (const config::Diagnostic& diagnostic : diagnostics.sorted())
        message += (message.empty() ? "" : "\n") + shearwake::config::text(diagnostic);
    throw UsageError(message);
}

void add_tolerance(Tolerances& tolerances, const std::string& text) {
    const std::size_t equals = text.rfind('=');
    double relative = -1.0;
    bool read = false;
    if (equals != std::string::npos && equals > 0) {
        const char* end = text.data() + text.size();
        const auto [stopped, problem] = std::from_chars(text.data() + equals + 1, end, relative);
        read = problem == std::errc() && stopped == end;
    }
    if (!read || !std::isfinite(relative) || relative < 0.0)
        throw UsageError(fmt::format(
            "--tolerance requires COLUMN=RELATIVE, as in --tolerance eta_at_1=1e-5, but got \"{}\"",
            text));
    const std::string column = text.substr(0, equals);
    Tolerance tolerance = tolerances.of(column);
    tolerance.relative = relative;
    put(tolerances, column, tolerance);
}

} // namespace shearwake::reduce
