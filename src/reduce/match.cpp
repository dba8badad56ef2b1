// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/match.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <map>

namespace shearwake::reduce {
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

} // namespace shearwake::reduce
