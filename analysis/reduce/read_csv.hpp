#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// A CSV file as it stands there: every cell is text, every row as long as the header.
struct TextTable {
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;

    std::optional<std::size_t> find(std::string_view column) const;
};

/// Reads RFC 4180, as `csv` writes it. Throws UsageError (environment) with `file_name` and the
/// line when it is empty, a quote stays open, a row is of another length or a column stands there
/// twice.
TextTable read_csv(std::string_view text, const std::string& file_name);

} // namespace shearwake
