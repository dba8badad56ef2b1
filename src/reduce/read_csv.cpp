// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/read_csv.hpp"

#include "base/csv.hpp"
#include "base/error.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::reduce {
namespace {

[[noreturn]] void fail(const std::string& file, std::size_t line, const std::string& what) {
    throw UsageError(fmt::format("{}:{}: this is not a valid table: {}", file, line, what),
                     ExitCode::environment);
}

bool next(CsvReader& reader, const std::string& file) {
    try {
        return reader.next();
    } catch (const CsvError& error) {
        fail(file, error.line, error.what());
    }
}

} // namespace

std::optional<std::size_t> TextTable::find(std::string_view column) const {
    const auto found = std::find(columns.begin(), columns.end(), column);
    if (found == columns.end()) return std::nullopt;
    return static_cast<std::size_t>(found - columns.begin());
}

TextTable read_csv(std::string_view text, const std::string& file_name) {
    CsvReader reader(text, CsvText::exact);
    if (!next(reader, file_name)) fail(file_name, 1, "the file is empty");
    TextTable table{.columns = reader.cells(), .rows = {}};
    std::vector<std::string> sorted = table.columns;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end())
        fail(file_name, 1, fmt::format("two columns are named \"{}\"", *twice));
    while (next(reader, file_name)) {
        if (reader.cells().size() != table.columns.size())
            fail(file_name, reader.line(),
                 fmt::format("{} cells for {} columns", reader.cells().size(),
                             table.columns.size()));
        table.rows.push_back(reader.cells());
    }
    return table;
}

} // namespace shearwake::reduce
