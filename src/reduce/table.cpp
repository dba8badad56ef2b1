// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/table.hpp"

#include "base/printable.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::reduce {
namespace {

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

std::string markdown_text(const std::string& text) {
    return one_line(text);
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

namespace {

/// The numbers of remarks in the order of their first appearance, from 1: "1, 3".
class Numbers {
public:
    std::string of(const std::vector<std::string>& remarks) {
        std::string text;
        for (const std::string& remark : remarks) {
            const auto found = std::find(remarks_.begin(), remarks_.end(), remark);
            const auto number = found - remarks_.begin() + 1;
            if (found == remarks_.end()) remarks_.push_back(remark);
            text += (text.empty() ? "" : ", ") + std::to_string(number);
        }
        return text;
    }

    /// A numbered list of all remarks; empty without remarks.
    std::string list() const {
        std::string text;
        for (std::size_t i = 0; i < remarks_.size(); ++i)
            text += (i ? "" : "\n") + std::to_string(i + 1) + ". " + one_line(remarks_[i]) + "\n";
        return text;
    }

private:
    std::vector<std::string> remarks_;
};

} // namespace

std::string markdown(const Table& table, const std::vector<std::string>& columns) {
    std::vector<std::size_t> chosen;
    for (const std::string& name : columns) {
        const auto found = std::find(table.columns.begin(), table.columns.end(), name);
        if (found != table.columns.end())
            chosen.push_back(static_cast<std::size_t>(found - table.columns.begin()));
    }
    std::string text = "|", rule = "|";
    for (const std::size_t i : chosen) {
        text += " " + one_line(table.columns[i]) + " |";
        rule += " --- |";
    }
    text += "\n" + rule + "\n";
    Numbers notes;
    for (std::size_t n = 0; n < table.rows.size(); ++n) {
        text += "|";
        for (const std::size_t i : chosen)
            text += " " +
                    (table.columns[i] == "note" && !table.remarks.empty()
                         ? notes.of(table.remarks[n])
                         : one_line(text_of(table.rows[n][i], 4))) +
                    " |";
        text += "\n";
    }
    return text + notes.list();
}

} // namespace shearwake::reduce
