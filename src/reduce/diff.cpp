// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/diff.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "config/document/tree.hpp"
#include "measures/measure_table.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <numbers>

namespace shearwake::reduce {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

std::optional<double> number(const std::string& text) {
    double value = 0.0;
    const char* end = text.data() + text.size();
    const auto [stopped, problem] = std::from_chars(text.data(), end, value);
    if (problem != std::errc() || stopped != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

struct Column {
    std::size_t now, reference;
    Tolerance tolerance;
    double largest = 0.0;  // largest magnitude of the references
    bool is_level = false; // in dB: a change is that of the amplitude, wherever 0 dB is
};

/// The difference of the cell, if any. If the whole column of the reference is 0, any change
/// without an absolute tolerance is a difference.
std::optional<MovedCell> moved_cell(const std::string& now, const std::string& reference,
                                    const Column& column) {
    if (now == reference) return std::nullopt;
    const auto a = number(now), b = number(reference);
    if (!a || !b) return MovedCell{"", now, reference, not_a_number, infinite};
    const double away = std::abs(*a - *b);
    const double scale = column.is_level ? 20.0 / std::numbers::ln10
                         : *b != 0.0     ? std::abs(*b)
                                         : column.largest;
    double allowed = column.tolerance.relative * scale;
    if (column.is_level || *b == 0.0) allowed = column.tolerance.absolute.value_or(allowed);
    if (away <= allowed) return std::nullopt;
    const double change = column.is_level ? std::expm1((*a - *b) / scale) : (*a - *b) / scale;
    return MovedCell{"", now, reference, scale > 0.0 ? change : not_a_number,
                     allowed > 0.0 ? away / allowed : infinite};
}

/// Largest first; differences without a tolerance are ordered by the change.
bool is_worse(const MovedCell& a, const MovedCell& b) {
    if (a.over_tolerance != b.over_tolerance) return a.over_tolerance > b.over_tolerance;
    const auto size = [](const MovedCell& c) {
        return std::isnan(c.change) ? infinite : std::abs(c.change);
    };
    return size(a) > size(b);
}

double largest_of(const TextTable& table, std::size_t column) {
    double largest = 0.0;
    for (const auto& row : table.rows)
        largest = std::max(largest, std::abs(number(row[column]).value_or(0.0)));
    return largest;
}

void require_columns(const Tolerances& tolerances, const TextTable& now,
                     const TextTable& reference) {
    std::vector<std::string> known = reference.columns;
    for (const std::string& column : now.columns)
        if (!reference.find(column)) known.push_back(column);
    std::vector<std::string> asked = tolerances.ignored;
    for (const auto& [column, tolerance] : tolerances.named)
        asked.push_back(column);
    for (const std::string& column : asked) {
        if (std::find(known.begin(), known.end(), column) != known.end()) continue;
        const auto meant = nearest(column, known);
        throw UsageError(fmt::format("tolerances: neither table has a column {}; {}", column,
                                     meant ? "did you mean " + *meant + "?"
                                           : "the first line of each table lists its columns"));
    }
}

} // namespace

bool Differences::none() const {
    return moved.empty() && missing_cases.empty() && extra_cases.empty() &&
           missing_columns.empty() && extra_columns.empty();
}

Differences compare(const TextTable& now, const TextTable& reference,
                    const Tolerances& tolerances) {
    require_columns(tolerances, now, reference);
    const Matched rows = match_rows(now, reference);
    Differences found;
    found.cases = rows.pairs.size();
    found.cases_of_other_id = rows.by_settings;
    for (const std::size_t row : rows.missing)
        found.missing_cases.push_back(row_name(reference, row));
    for (const std::size_t row : rows.extra)
        found.extra_cases.push_back(row_name(now, row));

    for (std::size_t i = 0; i < reference.columns.size(); ++i) {
        const std::string& name = reference.columns[i];
        if (name == "id") continue; // used for matching rows, not compared
        if (tolerances.ignores(name)) {
            found.not_compared.push_back(name);
            continue;
        }
        const auto there = now.find(name);
        if (!there) {
            found.missing_columns.push_back(name);
            continue;
        }
        const Column column{*there, i, tolerances.of(name), largest_of(reference, i),
                            name.ends_with("_dB")};
        found.compared.push_back({name, column.tolerance});
        MovedColumn moved{name, column.tolerance, {}};
        for (const RowPair& pair : rows.pairs) {
            auto cell = moved_cell(now.rows[pair.now][column.now],
                                   reference.rows[pair.reference][column.reference], column);
            if (!cell) continue;
            cell->case_name = row_name(reference, pair.reference);
            moved.cells.push_back(std::move(*cell));
        }
        std::stable_sort(moved.cells.begin(), moved.cells.end(), is_worse);
        if (!moved.cells.empty()) found.moved.push_back(std::move(moved));
    }
    for (const std::string& name : now.columns) {
        if (reference.find(name)) continue;
        (tolerances.ignores(name) ? found.not_compared : found.extra_columns).push_back(name);
    }
    std::stable_sort(found.moved.begin(), found.moved.end(), [](const auto& a, const auto& b) {
        return is_worse(a.cells.front(), b.cells.front());
    });
    return found;
}

std::filesystem::path table_in(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path))
        throw UsageError(fmt::format("{}: no such table (CSV) or output folder", path.string()),
                         ExitCode::environment);
    if (!std::filesystem::is_directory(path)) return path;
    const storage::PlanIndex plan = storage::read_plan(path / "plan.json");
    const auto table = path / "tables" / (plan.name + ".csv");
    if (!std::filesystem::exists(table))
        throw UsageError(
            fmt::format("{0} has no table yet; next: shearwake reduce {0}", path.string()),
            ExitCode::environment);
    return table;
}

namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

std::string cell(const TextTable& table, std::size_t row, std::string_view column) {
    const auto found = table.find(column);
    return found ? table.rows[row][*found] : "";
}

/// Equal numbers, such as 2 and 2.0, give the same text.
std::string settled(const std::string& text) {
    double value = 0.0;
    const char* end = text.data() + text.size();
    const auto [stopped, problem] = std::from_chars(text.data(), end, value);
    return problem == std::errc() && stopped == end ? fmt::format("{:.9g}", value) : text;
}

/// Rows that are not matched yet, by their swept values.
std::map<std::string, std::vector<std::size_t>> by_settings(const TextTable& table,
                                                            const std::vector<std::string>& keys,
                                                            const std::vector<bool>& taken) {
    std::map<std::string, std::vector<std::size_t>> rows;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        if (taken[row]) continue;
        std::string name = cell(table, row, "reference");
        for (const std::string& key : keys)
            name += '\n' + settled(cell(table, row, key));
        rows[name].push_back(row);
    }
    return rows;
}

} // namespace

std::vector<std::size_t> swept_columns(const TextTable& table) {
    std::size_t i = 0;
    while (i < table.columns.size() &&
           (table.columns[i] == "id" || table.columns[i] == "reference"))
        ++i;
    std::vector<std::size_t> columns;
    for (; i < table.columns.size() && table.columns[i].find('.') != std::string::npos; ++i)
        columns.push_back(i);
    return columns;
}

Matched match_rows(const TextTable& now, const TextTable& reference) {
    std::vector<std::size_t> partner(reference.rows.size(), none);
    std::vector<bool> taken(now.rows.size()), matched(reference.rows.size());
    Matched result;

    std::map<std::string, std::size_t> ids;
    for (std::size_t row = 0; row < now.rows.size(); ++row)
        ids.emplace(cell(now, row, "id"), row);
    for (std::size_t row = 0; row < reference.rows.size(); ++row) {
        const auto found = ids.find(cell(reference, row, "id"));
        if (found == ids.end() || found->first.empty() || taken[found->second]) continue;
        partner[row] = found->second;
        matched[row] = taken[found->second] = true;
    }

    std::vector<std::string> keys;
    for (const std::size_t column : swept_columns(reference))
        if (now.find(reference.columns[column])) keys.push_back(reference.columns[column]);
    const auto left_now = by_settings(now, keys, taken);
    for (const auto& [name, rows] : by_settings(reference, keys, matched)) {
        const auto found = left_now.find(name);
        if (found == left_now.end() || rows.size() != 1 || found->second.size() != 1) continue;
        partner[rows[0]] = found->second[0];
        taken[found->second[0]] = true;
        ++result.by_settings;
    }

    for (std::size_t row = 0; row < partner.size(); ++row)
        if (partner[row] == none)
            result.missing.push_back(row);
        else
            result.pairs.push_back({partner[row], row});
    for (std::size_t row = 0; row < taken.size(); ++row)
        if (!taken[row]) result.extra.push_back(row);
    return result;
}

std::string row_name(const TextTable& table, std::size_t row) {
    std::string name = cell(table, row, "reference") == "yes" ? "the reference" : "";
    for (const std::size_t column : swept_columns(table)) {
        const std::string& value = table.rows[row][column];
        if (!value.empty())
            name += fmt::format("{}{}={}", name.empty() ? "" : ", ", table.columns[column], value);
    }
    return name.empty() ? cell(table, row, "id") : name;
}

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
    const double value = config::as_number(*entry.value).value_or(-1.0);
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
