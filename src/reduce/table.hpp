// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "storage/journal/plan_file.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

namespace shearwake::reduce {

/// A cell: a number (NaN: empty) or text.
using Cell = std::variant<double, std::string>;

/// Rows of equal length under named columns.
struct Table {
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
    /// The sentences to which the numbers in the column "note" refer, "1, 3".
    std::vector<std::string> notes = {};

    std::optional<std::size_t> find(std::string_view column) const;
    /// The sentences of the note of a row; none in a table without notes.
    std::vector<std::string> note(std::size_t row) const;
};

/// Distinct values, numbered from 1 in the order of their first appearance.
class Numbering {
public:
    std::size_t operator[](const std::string& text) {
        const auto [entry, is_new] = numbers_.try_emplace(text, texts_.size() + 1);
        if (is_new) texts_.push_back(text);
        return entry->second;
    }
    const std::vector<std::string>& texts() const { return texts_; }

private:
    std::vector<std::string> texts_;
    std::unordered_map<std::string, std::size_t> numbers_;
};

/// A number of the table of a plan, whose rows are its cases in order. NaN: empty, no such column,
/// or not valid, since the readings of the case, or those of its reference for a ratio, are not.
double valid_value(const storage::PlanIndex& plan, const Table& table, std::size_t row,
                   const std::string& column);

/// Comma-separated, quoted where needed (RFC 4180), numbers with nine digits, empty cells empty.
std::string csv(const Table& table);

/// A title or a name as one line of Markdown.
std::string markdown_text(const std::string& text);

/// A pipe table of the named columns with their labels, in that order, numbers with four digits;
/// names that the table does not have are ignored. The sentences to which the column "note" refers
/// follow the table.
std::string markdown(const Table& table, const std::vector<std::string>& columns);

/// The first `most` rows of the named columns as aligned text below their labels.
std::string first_rows(const Table& table, const std::vector<std::string>& columns,
                       std::size_t most);

/// Case id -> column -> estimated numerical error, in the unit of the column.
using Errors = std::map<std::string, std::map<std::string, double>>;

/// The errors in a converge.json; none if there is no such file. Throws UsageError (environment) if
/// it is not valid. Not collective.
Errors read_errors(const std::filesystem::path& path);

/// The name of the column with the error of a column: "eta_at_1_error".
std::string error_column(const std::string& column);
/// The column whose error a column contains; empty if it contains none.
std::string column_of_error(const std::string& name);

/// The table with a column `<column>_error` after each of the `names` for which a case has an
/// error. Cases without an estimate have empty cells. The column `id` identifies the cases.
Table with_errors(const Table& table, const std::vector<std::string>& names, const Errors& errors);

} // namespace shearwake::reduce
