// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/table.hpp"

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/labels.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "measures/measure_table.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <sstream>

namespace shearwake::reduce {

namespace {

std::optional<std::size_t> find_in(const std::vector<std::string>& columns,
                                   std::string_view column) {
    const auto found = std::ranges::find(columns, column);
    if (found == columns.end()) return std::nullopt;
    return static_cast<std::size_t>(found - columns.begin());
}

std::string text_of(const Cell& cell, int digits) {
    if (const auto* words = std::get_if<std::string>(&cell)) return *words;
    const double value = std::get<double>(cell);
    return std::isnan(value) ? "" : fmt::format("{:.{}g}", value, digits);
}

/// A text cell. Spreadsheets interpret text that begins with = + - @ as a formula, so an
/// apostrophe, which marks text, is added.
std::string csv_cell(const Cell& cell) {
    std::string text = printable(text_of(cell, 9));
    const bool is_words = std::holds_alternative<std::string>(cell);
    if (is_words && !text.empty() &&
        std::string_view("=+-@").find(text.front()) != std::string::npos)
        text.insert(0, 1, '\'');
    return text;
}

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"') out += '"';
        out += c;
    }
    return out + '"';
}

/// Escapes characters with a special meaning in Markdown and HTML.
std::string one_line(const std::string& text) {
    std::string out;
    for (const char c : printable(text)) {
        if (std::string_view("|\\`*[]").find(c) != std::string_view::npos) out += '\\';
        if (c == '<' || c == '&')
            out += c == '<' ? "&lt;" : "&amp;";
        else
            out += c == '\n' || c == '\r' ? ' ' : c;
    }
    return out;
}

} // namespace

std::optional<std::size_t> Table::find(std::string_view column) const {
    return find_in(columns, column);
}

std::vector<std::string> Table::note(std::size_t row) const {
    std::vector<std::string> sentences;
    if (notes.empty()) return sentences;
    std::istringstream numbers(std::get<std::string>(rows[row][find("note").value()]));
    for (std::string number; next_line(numbers, number, ',');)
        sentences.push_back(notes.at(std::stoul(number) - 1));
    return sentences;
}

std::string markdown_text(const std::string& text) {
    return one_line(text);
}

double valid_value(const storage::PlanIndex& plan, const Table& table, std::size_t row,
                   const std::string& column) {
    const auto cell = [&](std::size_t of, const std::string& name) {
        const auto place = table.find(name);
        return place ? table.rows[of][*place] : Cell(not_a_number);
    };
    const Cell no = std::string("no");
    if (cell(row, "valid") == no) return not_a_number;
    const measures::Measure* measure = measures::find_measure(column);
    const auto reference =
        measure && *measure->over_reference_of
            ? std::ranges::find(plan.cases, plan.cases[row].reference_id, &storage::IndexedCase::id)
            : plan.cases.end();
    if (reference != plan.cases.end() &&
        cell(static_cast<std::size_t>(reference - plan.cases.begin()), "valid") == no)
        return not_a_number;
    const Cell value = cell(row, column);
    const double* number = std::get_if<double>(&value);
    return number ? *number : not_a_number;
}

std::string csv(const Table& table) {
    std::string text;
    for (std::size_t i = 0; i < table.columns.size(); ++i)
        text += (i ? "," : "") + quoted(table.columns[i]);
    text += '\n';
    for (const auto& row : table.rows) {
        for (std::size_t i = 0; i < row.size(); ++i)
            text += (i ? "," : "") + quoted(csv_cell(row[i]));
        text += '\n';
    }
    return text;
}

std::string markdown(const Table& table, const std::vector<std::string>& columns) {
    std::vector<std::size_t> chosen;
    for (const std::string& name : columns)
        if (const auto found = table.find(name)) chosen.push_back(*found);
    std::string text = "|", rule = "|";
    for (const std::size_t i : chosen) {
        text += " " + one_line(axis_label(table.columns[i])) + " |";
        rule += " --- |";
    }
    text += "\n" + rule + "\n";
    for (const std::vector<Cell>& row : table.rows) {
        text += "|";
        for (const std::size_t i : chosen)
            text += " " + one_line(text_of(row[i], 4)) + " |";
        text += "\n";
    }
    const bool has_notes = std::ranges::find(columns, "note") != columns.end();
    for (std::size_t n = 0; has_notes && n < table.notes.size(); ++n)
        text += fmt::format("{}{}. {}\n", n > 0 ? "" : "\n", n + 1, one_line(table.notes[n]));
    return text;
}

namespace {

/// The number of characters of UTF-8, each of which takes one place in a terminal here.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count_if(
        text, [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
}

/// The words of a label on lines of about `width` characters.
std::vector<std::string> wrapped(const std::string& label, std::size_t width) {
    std::vector<std::string> lines(1);
    std::istringstream words(label);
    for (std::string word; words >> word;) {
        if (!lines.back().empty() && width_of(lines.back()) + 1 + width_of(word) > width)
            lines.emplace_back();
        lines.back() += (lines.back().empty() ? "" : " ") + word;
    }
    return lines;
}

} // namespace

std::string first_rows(const Table& table, const std::vector<std::string>& columns,
                       std::size_t most) {
    constexpr std::size_t label_width = 18;
    std::vector<std::vector<std::string>> cells; // of each column, from the top
    std::vector<std::size_t> heights;            // of the labels
    for (const std::string& name : columns) {
        const auto column = table.find(name);
        if (!column) continue;
        cells.push_back(wrapped(axis_label(name), label_width));
        heights.push_back(cells.back().size());
        for (std::size_t n = 0; n < std::min(most, table.rows.size()); ++n)
            cells.back().push_back(one_line(text_of(table.rows[n][*column], 4)));
    }
    std::vector<std::string> lines;
    const std::size_t height = heights.empty() ? 0 : std::ranges::max(heights);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        cells[i].insert(cells[i].begin(), height - heights[i], "");
        lines.resize(cells[i].size());
        std::size_t width = 0;
        for (const std::string& cell : cells[i])
            width = std::max(width, width_of(cell));
        for (std::size_t n = 0; n < lines.size(); ++n)
            lines[n] +=
                std::string(width - width_of(cells[i][n]) + (i > 0 ? 2 : 0), ' ') + cells[i][n];
    }
    for (std::string& line : lines) // labels differ in height
        line.erase(line.find_last_not_of(' ') + 1);
    return fmt::format("{}\n", fmt::join(lines, "\n"));
}

namespace {

constexpr std::string_view suffix = "_error";

} // namespace

Errors read_errors(const std::filesystem::path& path) {
    Errors errors;
    if (!std::filesystem::exists(path)) return errors;
    try {
        const Json root = Json::parse(storage::unseal(storage::read_file(path)).value_or(""));
        for (const Json& c : root.at("cases")) {
            auto& found = errors[c.at("id").get<std::string>()];
            for (const auto& [column, entry] : c.at("columns").items())
                if (entry.at("error").is_number()) found[column] = entry.at("error").get<double>();
        }
    } catch (const JsonError&) {
        throw UsageError(fmt::format("{} is not a table of errors, or is damaged: it is truncated "
                                     "or does not match its checksum; rerun shearwake converge, or "
                                     "shearwake measure for a scan",
                                     path.string()),
                         ExitCode::environment);
    }
    return errors;
}

std::string error_column(const std::string& column) {
    return column + std::string(suffix);
}

std::string column_of_error(const std::string& name) {
    return name.ends_with(suffix) ? name.substr(0, name.size() - suffix.size()) : "";
}

Table with_errors(const Table& table, const std::vector<std::string>& names, const Errors& errors) {
    const auto has_errors = [&](const std::string& name) {
        return std::ranges::find(names, name) != names.end() &&
               std::ranges::any_of(errors, [&](const auto& c) { return c.second.contains(name); });
    };
    Table extended;
    extended.notes = table.notes;
    extended.rows.resize(table.rows.size());
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        const std::string& name = table.columns[i];
        const bool extends = has_errors(name);
        extended.columns.push_back(name);
        if (extends) extended.columns.push_back(error_column(name));
        for (std::size_t row = 0; row < table.rows.size(); ++row) {
            extended.rows[row].push_back(table.rows[row][i]);
            if (!extends) continue;
            const auto found = errors.find(std::get<std::string>(table.rows[row][0]));
            const bool known = found != errors.end() && found->second.contains(name);
            extended.rows[row].emplace_back(known ? found->second.at(name) : not_a_number);
        }
    }
    return extended;
}

} // namespace shearwake::reduce
