#include "reduce/tolerance.hpp"

#include "base/error.hpp"
#include "config/tree.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace shearwake {
namespace {

constexpr std::string_view all_others = "*";

void put(Tolerances& tolerances, const std::string& column, const Tolerance& tolerance) {
    if (column == all_others)
        tolerances.others = tolerance;
    else
        tolerances.named[column] = tolerance;
}

/// A number from 0 on, or nothing and a finding.
std::optional<double> amount(const Entry& entry, Diagnostics& findings) {
    double value = -1.0;
    if (const auto* whole = std::get_if<std::int64_t>(&entry.value->value))
        value = static_cast<double>(*whole);
    else if (const auto* number = std::get_if<double>(&entry.value->value))
        value = *number;
    if (std::isfinite(value) && value >= 0.0) return value;
    findings.error(entry.value->at, fmt::format("{} wants a number from 0 on; it is {}",
                                                excerpt(entry.key), excerpt(render(*entry.value))));
    return std::nullopt;
}

void read_table(const Entry& column, const TableNode& table, Tolerances& tolerances,
                Diagnostics& findings) {
    Tolerance tolerance = tolerances.of(column.key);
    for (const Entry& entry : table.entries) {
        if (entry.key == "relative")
            tolerance.relative = amount(entry, findings).value_or(0.0);
        else if (entry.key == "absolute")
            tolerance.absolute = amount(entry, findings);
        else
            findings.error(entry.key_at,
                           fmt::format("{}.{} is unknown; there are relative and absolute",
                                       excerpt(column.key), excerpt(entry.key)));
    }
    put(tolerances, column.key, tolerance);
}

void read_columns(const Entry& section, Tolerances& tolerances, Diagnostics& findings) {
    const auto* table = std::get_if<TableNode>(&section.value->value);
    if (!table) {
        findings.error(section.value->at, "tolerance wants a table: [tolerance], and below it a "
                                          "line COLUMN = RELATIVE each");
        return;
    }
    for (const Entry& entry : table->entries)
        if (const auto* parts = std::get_if<TableNode>(&entry.value->value))
            read_table(entry, *parts, tolerances, findings);
        else if (const auto relative = amount(entry, findings))
            put(tolerances, entry.key, {.relative = *relative});
}

void read_ignored(const Entry& entry, Tolerances& tolerances, Diagnostics& findings) {
    const auto* list = std::get_if<ListNode>(&entry.value->value);
    bool words = list != nullptr;
    for (std::size_t i = 0; words && i < list->size(); ++i) {
        const auto* word = std::get_if<std::string>(&(*list)[i]->value);
        words = word != nullptr;
        if (words) tolerances.ignored.push_back(*word);
    }
    if (!words)
        findings.error(entry.value->at, "ignore wants a list of columns: ignore = [\"peak_um\"]");
}

} // namespace

Tolerance default_tolerance(std::string_view column) {
    // The literal ipr is what is left of sum u after its parts have cancelled. Its root is exact to
    // 1e-12 of the root of ipr_abs, which at the thesis' c_p is 1e6 times as large: 1e-6 of itself,
    // twice that when squared. A factor 50 for compilers and for other media.
    if (column.starts_with("ipr_") && !column.starts_with("ipr_abs")) return {.relative = 1e-4};
    // Tables carry nine digits, so that two roundings may differ by 1e-8 of a number; the factor 10
    // is for readings fitted to or divided by other readings.
    return {.relative = 1e-7};
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
    Diagnostics findings;
    Tolerances tolerances;
    const NodePtr root = parse_toml(text, file_name, findings);
    if (root) {
        for (const Entry& entry : std::get<TableNode>(root->value).entries) {
            if (entry.key == "tolerance")
                read_columns(entry, tolerances, findings);
            else if (entry.key == "ignore")
                read_ignored(entry, tolerances, findings);
            else
                findings.error(entry.key_at,
                               fmt::format("{} is unknown; there are [tolerance] and, above it, "
                                           "ignore = [...]",
                                           excerpt(entry.key)));
        }
    }
    if (findings.errors() == 0) return tolerances;
    std::string message;
    for (const Finding& finding : findings.sorted())
        message += (message.empty() ? "" : "\n") + shearwake::text(finding);
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
        throw UsageError(fmt::format("--tolerance wants COLUMN=RELATIVE, as in --tolerance "
                                     "eta_at_1=1e-5; it got \"{}\"",
                                     text));
    const std::string column = text.substr(0, equals);
    Tolerance tolerance = tolerances.of(column);
    tolerance.relative = relative;
    put(tolerances, column, tolerance);
}

} // namespace shearwake
