// SPDX-License-Identifier: BSD-3-Clause
#include "base/labels.hpp"

#include "base/csv.hpp"
#include "labels_csv.hpp"

#include <algorithm>
#include <optional>
#include <vector>

namespace shearwake {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// The rows of a kind: name, label and, for units, the notation of CF.
Rows rows_of(std::string_view kind) {
    Rows rows;
    for (CsvReader reader(labels_csv); reader.next();)
        if (reader.cells().at(0) == kind)
            rows.emplace_back(reader.cells().begin() + 1, reader.cells().end());
    return rows;
}

const Rows& unit_rows() {
    static const Rows rows = rows_of("unit");
    return rows;
}

const Rows& label_rows() {
    static const Rows rows = rows_of("name");
    return rows;
}

/// Replaces the words in braces of a label by what they stand for in a name; false if the name does
/// not match the pattern.
bool fill(std::string_view pattern, std::string_view name, std::string& label) {
    const std::size_t open = pattern.find('{');
    if (open == std::string_view::npos) return pattern == name;
    if (name.substr(0, open) != pattern.substr(0, open)) return false;
    const std::string word(pattern.substr(open, pattern.find('}') + 1 - open));
    for (std::size_t end = open + 1; end <= name.size(); ++end) {
        std::string filled = label;
        if (const std::size_t at = filled.find(word); at != std::string::npos)
            filled.replace(at, word.size(), name.substr(open, end - open));
        if (!fill(pattern.substr(open + word.size()), name.substr(end), filled)) continue;
        label = filled;
        return true;
    }
    return false;
}

std::optional<std::string> find_label(std::string_view name) {
    for (const auto& row : label_rows())
        if (std::string label = row[1]; fill(row[0], name, label)) return label;
    return std::nullopt;
}

/// A name without what follows its unit: ", z = 1.5 mm" for "_z1.5mm" and ", error" for "_error".
struct Ending {
    std::string_view name;
    std::string text;
};

Ending ending_of(std::string_view name) {
    constexpr std::string_view error = "_error";
    if (name.ends_with(error)) {
        const Ending inner = ending_of(name.substr(0, name.size() - error.size()));
        return {inner.name, inner.text + ", error"};
    }
    const std::size_t depth = name.rfind("_z");
    if (depth != std::string_view::npos && name.ends_with("mm") &&
        name.substr(depth + 2).find_first_not_of("0123456789.e-+m") == std::string_view::npos)
        return {name.substr(0, depth),
                ", z = " + std::string(name.substr(depth + 2, name.size() - depth - 4)) + " mm"};
    return {name, ""};
}

/// The row of the longest unit at the end of a name; null without one.
const std::vector<std::string>* find_unit(std::string_view name) {
    const std::vector<std::string>* longest = nullptr;
    for (const auto& row : unit_rows())
        if (name.size() > row[0].size() + 1 && name.ends_with("_" + row[0]) &&
            (!longest || row[0].size() > longest->front().size()))
            longest = &row;
    return longest;
}

/// The part after the last point that a letter follows: a depth may contain a point, as in
/// "eta_at_1_z1.5mm".
std::string_view last_part(std::string_view name) {
    std::size_t point = name.rfind('.');
    while (point != std::string_view::npos && point + 1 < name.size() && name[point + 1] <= '9')
        point = point == 0 ? std::string_view::npos : name.rfind('.', point - 1);
    return name.substr(point + 1);
}

/// ", layer 1" of "medium.layer[1].c_s_m_s".
std::string place_of(std::string_view key) {
    for (const std::string_view list : {"layer[", "body["}) {
        const std::size_t at = key.find(list);
        if (at == std::string_view::npos) continue;
        const std::size_t number = at + list.size();
        return ", " + std::string(list.substr(0, list.size() - 1)) + " " +
               std::string(key.substr(number, key.find(']', number) - number));
    }
    return "";
}

} // namespace

std::string label_of(std::string_view name) {
    const Ending part = ending_of(last_part(name));
    std::string_view word = part.name;
    if (const auto* unit = find_unit(word)) word.remove_suffix(unit->front().size() + 1);
    std::optional<std::string> found = find_label(part.name);
    if (!found) found = find_label(word);
    if (!found) {
        found = std::string(word);
        std::ranges::replace(*found, '_', ' ');
    }
    return *found + part.text + place_of(name);
}

std::string unit_label(std::string_view name) {
    const auto* unit = find_unit(ending_of(last_part(name)).name);
    return unit ? (*unit)[1] : "";
}

std::string axis_label(std::string_view name) {
    const std::string unit = unit_label(name);
    return unit.empty() ? label_of(name) : label_of(name) + " (" + unit + ")";
}

} // namespace shearwake
