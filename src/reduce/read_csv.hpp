// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::reduce {

/// The content of a CSV file: every cell is text, and every row has the length of the header.
struct TextTable {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;

    std::optional<std::size_t> find(std::string_view column) const;
};

/// Reads RFC 4180, as `csv` writes it. Throws UsageError (environment) with `file_name` and the
/// line if the file is empty, a quote is not closed, a row has a different length or a column
/// occurs twice.
TextTable read_csv(std::string_view text, const std::string& file_name);

} // namespace shearwake::reduce
