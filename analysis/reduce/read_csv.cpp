#include "reduce/read_csv.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake {
namespace {

/// Takes one row after the other off the text.
class RowReader {
public:
    RowReader(std::string_view text, const std::string& file) : rest_(text), file_(file) {
        constexpr std::string_view byte_order_mark = "\xef\xbb\xbf"; // spreadsheets write one
        if (rest_.starts_with(byte_order_mark)) rest_.remove_prefix(byte_order_mark.size());
    }

    bool at_end() const { return rest_.empty(); }
    int line() const { return line_; }

    std::vector<std::string> row() {
        std::vector<std::string> cells;
        do
            cells.push_back(cell());
        while (take(','));
        take('\r');
        if (!rest_.empty() && !take('\n')) fail("a quoted cell goes on behind its closing quote");
        ++line_;
        return cells;
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw UsageError(fmt::format("{}:{}: this is no table: {}", file_, line_, what),
                         ExitCode::environment);
    }

private:
    bool take(char c) {
        if (rest_.empty() || rest_.front() != c) return false;
        rest_.remove_prefix(1);
        return true;
    }

    std::string cell() {
        if (take('"')) return quoted_cell();
        const std::string text(rest_.substr(0, rest_.find_first_of(",\r\n")));
        rest_.remove_prefix(text.size());
        return text;
    }

    std::string quoted_cell() {
        std::string text;
        int breaks = 0;
        while (!rest_.empty()) {
            const char c = rest_.front();
            rest_.remove_prefix(1);
            if (c == '"' && !take('"')) {
                line_ += breaks;
                return text;
            }
            breaks += c == '\n';
            text += c;
        }
        fail("a quote that is never closed");
    }

    std::string_view rest_;
    const std::string& file_;
    int line_ = 1;
};

} // namespace

std::optional<std::size_t> TextTable::find(std::string_view column) const {
    const auto found = std::find(columns.begin(), columns.end(), column);
    if (found == columns.end()) return std::nullopt;
    return static_cast<std::size_t>(found - columns.begin());
}

TextTable read_csv(std::string_view text, const std::string& file_name) {
    RowReader reader(text, file_name);
    if (reader.at_end()) reader.fail("it is empty");
    TextTable table{.columns = reader.row(), .rows = {}};
    std::vector<std::string> sorted = table.columns;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end())
        throw UsageError(
            fmt::format("{}:1: this is no table: two columns are called \"{}\"", file_name, *twice),
            ExitCode::environment);
    while (!reader.at_end()) {
        const int line = reader.line();
        table.rows.push_back(reader.row());
        if (table.rows.back().size() != table.columns.size())
            throw UsageError(fmt::format("{}:{}: this is no table: {} cells under {} columns",
                                         file_name, line, table.rows.back().size(),
                                         table.columns.size()),
                             ExitCode::environment);
    }
    return table;
}

} // namespace shearwake
