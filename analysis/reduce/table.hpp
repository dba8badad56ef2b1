#pragma once

#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// A cell: a number (NaN: empty) or words.
using Cell = std::variant<double, std::string>;

/// Rows of equal length under named columns.
struct Table {
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
};

/// Comma-separated, quoted where needed (RFC 4180), numbers with nine digits, empty cells empty.
std::string csv(const Table& table);

/// A pipe table of the named columns, in that order, numbers with four digits; names that the table
/// does not have are passed over.
std::string markdown(const Table& table, const std::vector<std::string>& columns);

} // namespace shearwake
