// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace shearwake::reduce {

/// A cell: a number (NaN: empty) or text.
using Cell = std::variant<double, std::string>;

/// Rows of equal length under named columns.
struct Table {
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
    /// Per row, the sentences of its cell "note"; empty without notes.
    std::vector<std::vector<std::string>> remarks = {};
};

/// Comma-separated, quoted where needed (RFC 4180), numbers with nine digits, empty cells empty.
std::string csv(const Table& table);

/// A title or a name as one line of Markdown.
std::string markdown_text(const std::string& text);

/// A pipe table of the named columns, in that order, numbers with four digits; names that the table
/// does not have are ignored. The column "note" has numbers of remarks, which follow the table once
/// each.
std::string markdown(const Table& table, const std::vector<std::string>& columns);

} // namespace shearwake::reduce
