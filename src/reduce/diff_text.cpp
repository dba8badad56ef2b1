// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/diff.hpp"

#include "base/json.hpp"
#include "base/text.hpp"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace shearwake::reduce {
namespace {

/// "became empty", "+2.3 %, 2.3e+05 times its tolerance of 1e-07"
std::string change_text(const MovedCell& cell, const Tolerance& tolerance) {
    if (cell.now.empty()) return "became empty";
    if (cell.reference.empty()) return "was empty";
    if (std::isnan(cell.change) && std::isinf(cell.over_tolerance)) return "other";
    std::string text = std::isnan(cell.change) ? "" : fmt::format("{:+.3g} %", 100.0 * cell.change);
    if (std::isfinite(cell.over_tolerance))
        text += fmt::format("{}{:.2g} times its tolerance ({:g})", text.empty() ? "" : ", ",
                            cell.over_tolerance, tolerance.relative);
    return text;
}

std::string shown(const std::string& text) {
    return text.empty() ? "(empty)" : text;
}

/// "missing case: ..." on one line each, up to a limit.
std::string lines(const char* what, const std::vector<std::string>& items) {
    constexpr std::size_t most = 20;
    std::string text;
    for (std::size_t i = 0; i < items.size() && i < most; ++i)
        text += fmt::format("{}: {}\n", what, items[i]);
    if (items.size() > most) text += fmt::format("{}: {} more\n", what, items.size() - most);
    return text;
}

} // namespace

std::string words(const Differences& differences) {
    std::string text;
    std::size_t width = 0;
    for (const MovedColumn& column : differences.moved)
        width = std::max(width, column.column.size());
    for (const MovedColumn& column : differences.moved) {
        const MovedCell& worst = column.cells.front();
        text += fmt::format("{:<{}}  {}: {} -> {} at {}", column.column, width,
                            change_text(worst, column.tolerance), shown(worst.reference),
                            shown(worst.now), worst.case_name);
        if (column.cells.size() > 1)
            text += fmt::format("; {} of {} cases changed", column.cells.size(), differences.cases);
        text += '\n';
    }
    text += lines("missing column", differences.missing_columns);
    text += lines("extra column", differences.extra_columns);
    text += lines("missing case", differences.missing_cases);
    text += lines("extra case", differences.extra_cases);
    if (differences.cases_of_other_id > 0)
        text += fmt::format("{} with different ids, matched by swept values\n",
                            counted(differences.cases_of_other_id, "case"));
    if (!differences.not_compared.empty())
        text += fmt::format("not compared: {}\n", fmt::join(differences.not_compared, ", "));
    text += fmt::format("{}, {} compared: ", counted(differences.cases, "case"),
                        counted(differences.compared.size(), "column"));
    if (differences.none()) return text + "no difference\n";
    return text +
           fmt::format(
               "{} changed, {} and {} missing or extra\n",
               counted(differences.moved.size(), "column"),
               counted(differences.missing_columns.size() + differences.extra_columns.size(),
                       "column"),
               counted(differences.missing_cases.size() + differences.extra_cases.size(), "case"));
}

std::string json_text(const Differences& differences, const std::filesystem::path& now,
                      const std::filesystem::path& reference) {
    using Json = nlohmann::ordered_json;
    Json moved = Json::array();
    for (const MovedColumn& column : differences.moved) {
        Json cells = Json::array();
        for (const MovedCell& cell : column.cells)
            // JSON has no NaN and no infinity: null.
            cells.push_back({{"case", cell.case_name},
                             {"now", cell.now},
                             {"reference", cell.reference},
                             {"change", cell.change},
                             {"over_tolerance", cell.over_tolerance},
                             {"words", change_text(cell, column.tolerance)}});
        moved.push_back({{"column", column.column}, {"cells", cells}});
    }
    Json tolerances = Json::object(); // of all compared columns
    for (const ComparedColumn& compared : differences.compared)
        tolerances[compared.column] = compared.tolerance.relative;
    const Json all = {{"now", now.string()},
                      {"reference", reference.string()},
                      {"equal", differences.none()},
                      {"text", words(differences)},
                      {"moved", moved},
                      {"missing_columns", differences.missing_columns},
                      {"extra_columns", differences.extra_columns},
                      {"missing_cases", differences.missing_cases},
                      {"extra_cases", differences.extra_cases},
                      {"tolerances", tolerances},
                      {"not_compared", differences.not_compared},
                      {"cases", differences.cases},
                      {"cases_of_other_id", differences.cases_of_other_id}};
    return json_document("diff", all);
}

} // namespace shearwake::reduce
