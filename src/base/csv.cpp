// SPDX-License-Identifier: BSD-3-Clause
#include "base/csv.hpp"

#include "base/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace shearwake {

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::optional<double> number_in(std::string_view cell) {
    double value = 0.0;
    if (cell.size() > 1 && cell[0] == '+' && cell[1] != '-') cell.remove_prefix(1);
    const char* end = cell.data() + cell.size();
    const auto [stopped, error] = std::from_chars(cell.data(), end, value);
    return error == std::errc() && stopped == end ? std::optional(value) : std::nullopt;
}

std::optional<double> finite_number_in(std::string_view cell) {
    const auto value = number_in(cell);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

CsvReader::CsvReader(std::string_view text) : rest_(text) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf"; // spreadsheets write one
    if (rest_.starts_with(byte_order_mark)) rest_.remove_prefix(byte_order_mark.size());
}

bool CsvReader::next() {
    while (!rest_.empty()) {
        line_ = next_line_;
        text_ = trimmed(rest_.substr(0, rest_.find('\n')));
        if (text_.empty() || text_.front() == '#') {
            comment_ = text_.empty() ? text_ : trimmed(text_.substr(1));
            rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size() - 1) + 1);
            ++next_line_;
            continue;
        }
        const std::string_view row = rest_;
        read_cells();
        if (columns_ == 0 && has_commented_header()) {
            rest_ = comment_;
            read_cells();
            rest_ = row;
            text_ = comment_;
            --line_;
            check_row();
            return true;
        }
        if (!rest_.empty() && !consume('\n'))
            throw CsvError(next_line_, "a quoted cell that continues after its closing quote");
        check_row();
        ++next_line_;
        return true;
    }
    return false;
}

void CsvReader::read_cells() {
    cells_.clear();
    const std::size_t other = text_.find_first_of(";\t");
    if (columns_ == 0 && text_.find(',') == text_.npos && other != text_.npos)
        separator_ = text_[other];
    do {
        if (cells_.size() == most_csv_cells)
            throw CsvError(line_, fmt::format("more than {} cells", most_csv_cells));
        cells_.push_back(cell());
    } while (consume(separator_));
    consume('\r');
}

bool CsvReader::has_commented_header() const {
    const auto is_number = [](const std::string& cell) { return number_in(cell).has_value(); };
    return !comment_.empty() && std::ranges::all_of(cells_, is_number) &&
           std::ranges::count(comment_, separator_) + 1 == std::ssize(cells_);
}

void CsvReader::check_row() {
    while (cells_.size() > std::max<std::size_t>(columns_, 1) && cells_.back().empty())
        cells_.pop_back();
    if (columns_ == 0) columns_ = cells_.size();
    if (cells_.size() > columns_)
        throw CsvError(line_,
                       fmt::format("{} cells, but the first row has {}; write decimal numbers "
                                   "with a point",
                                   cells_.size(), columns_));
    for (const std::string& cell : cells_)
        if (with_decimal_point(cell))
            throw CsvError(line_, fmt::format("the number \"{:.40}\" with a decimal comma; write "
                                              "decimal numbers with a point",
                                              cell));
}

bool CsvReader::consume(char c) {
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
}

std::string CsvReader::cell() {
    if (consume('"')) return quoted_cell();
    const char ends[] = {separator_, '\r', '\n'};
    const std::string_view text =
        rest_.substr(0, rest_.find_first_of(std::string_view(ends, std::size(ends))));
    if (text.size() > longest_csv_cell) refuse_length();
    rest_.remove_prefix(text.size());
    return std::string(trimmed(text));
}

void CsvReader::refuse_length() const {
    throw CsvError(line_, fmt::format("a cell of more than {} characters", longest_csv_cell));
}

std::string CsvReader::quoted_cell() {
    std::string text;
    std::size_t breaks = 0;
    while (!rest_.empty()) {
        const char c = rest_.front();
        rest_.remove_prefix(1);
        if (c == '"' && !consume('"')) {
            next_line_ += breaks;
            return text;
        }
        breaks += c == '\n';
        if (text.size() == longest_csv_cell) refuse_length();
        text += c;
    }
    throw CsvError(next_line_, "a quote that is never closed");
}

} // namespace shearwake
