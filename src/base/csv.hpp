// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// What is wrong with a CSV text, and in which line of it.
struct CsvError : std::runtime_error {
    CsvError(std::size_t at_line, const std::string& what)
        : std::runtime_error(what), line(at_line) {}
    std::size_t line;
};

/// Limits of a row, since a cell takes more memory than the two characters that it may have in the
/// file.
constexpr std::size_t most_csv_cells = 100'000, longest_csv_cell = 100'000;

/// Takes one row after the other off a CSV text (RFC 4180). A byte order mark, blanks around cells,
/// empty lines and lines that begin with # are passed over. The cells are separated by semicolons
/// or tabs if the first row contains them and no comma; decimal commas, also those that divide
/// cells, are errors. A comment directly before a first row of numbers is the first row if it has
/// as many cells, as numpy.savetxt writes the names of columns. Throws CsvError.
class CsvReader {
public:
    explicit CsvReader(std::string_view text);

    /// Goes to the next row; false at the end.
    bool next();
    const std::vector<std::string>& cells() const { return cells_; }
    /// The line on which the row begins, from 1, and its text.
    std::size_t line() const { return line_; }
    std::string_view text() const { return text_; }

private:
    bool consume(char c);
    void read_cells();
    bool has_commented_header() const;
    void check_row();
    std::string cell();
    std::string quoted_cell();
    [[noreturn]] void refuse_length() const;

    std::string_view rest_, text_;
    std::string_view comment_; // the line before the row, without #
    char separator_ = ',';
    std::size_t columns_ = 0; // of the first row
    std::size_t line_ = 0, next_line_ = 1;
    std::vector<std::string> cells_;
};

/// Without the blanks around it.
std::string_view trimmed(std::string_view text);
/// The number that all of `cell` is, perhaps infinite or nan.
std::optional<double> number_in(std::string_view cell);
std::optional<double> finite_number_in(std::string_view cell);

} // namespace shearwake
