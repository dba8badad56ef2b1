// SPDX-License-Identifier: BSD-3-Clause
// On "[ =", an assertion of toml++ 3.3.0 fails before the library reports the error itself one line
// later. Its assertions are disabled, so that builds with assertions also report the error.
#define TOML_ASSERT(expression) static_assert(true)

#include "base/text.hpp"
#include "config/document/tree.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <toml++/toml.h>
#include <tuple>

namespace shearwake::config {
namespace {

constexpr int most_levels = 64;

Place place(const toml::source_region& region, const std::shared_ptr<const std::string>& file) {
    return {file, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

/// Converts toml++ nodes to those of this program.
class Converter {
public:
    Converter(std::shared_ptr<const std::string> file, DiagnosticList& diagnostics)
        : file_(std::move(file)), diagnostics_(diagnostics) {}

    NodePtr convert(const toml::node& node, int level) {
        const Place at = place(node.source(), file_);
        if (level > most_levels) {
            diagnostics_.error(at, fmt::format("nested deeper than {} levels", most_levels));
            return make_node(TableNode{}, at);
        }
        if (const auto* table = node.as_table()) return make_node(entries(*table, level), at);
        if (const auto* array = node.as_array()) {
            ListNode list;
            for (const toml::node& item : *array)
                list.push_back(convert(item, level + 1));
            return make_node(std::move(list), at);
        }
        if (const auto* text = node.as_string()) return make_node(text->get(), at);
        if (const auto* integer = node.as_integer()) return make_node(integer->get(), at);
        if (const auto* number = node.as_floating_point()) return make_node(number->get(), at);
        if (const auto* flag = node.as_boolean()) return make_node(flag->get(), at);
        return make_node(DateNode{}, at);
    }

private:
    TableNode entries(const toml::table& table, int level) {
        TableNode out;
        for (const auto& [key, value] : table)
            out.entries.push_back(
                {std::string(key.str()), place(key.source(), file_), convert(value, level + 1)});
        // toml++ sorts keys by name; restore the order of the file.
        std::stable_sort(out.entries.begin(), out.entries.end(), [](const auto& a, const auto& b) {
            return std::tie(a.key_at.line, a.key_at.column) <
                   std::tie(b.key_at.line, b.key_at.column);
        });
        return out;
    }

    std::shared_ptr<const std::string> file_;
    DiagnosticList& diagnostics_;
};

bool is_key_character(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return std::isalnum(byte) || c == '_' || c == '-' || c == '"' || c == '\'' || byte >= 0x80;
}

/// The line of the first dotted key with more than `most_levels` parts, or 0. The parser creates
/// one level of tables per part and frees them recursively, which could exhaust the stack.
int line_of_endless_key(std::string_view text) {
    int line = 1, parts = 0;
    char previous = '\n'; // the last character that is not a space or tab
    bool blank_before = false;
    for (const char c : text) {
        if (c == '\n') ++line;
        if (c == ' ' || c == '\t') {
            blank_before = true;
            continue;
        }
        if (c == '.' && is_key_character(previous))
            ++parts;
        else if (!is_key_character(c) || (blank_before && previous != '.'))
            parts = 0;
        if (parts > most_levels) return line;
        blank_before = false;
        previous = c;
    }
    return 0;
}

/// The end of the string whose opening quotes are at `at`.
std::size_t end_of_string(std::string_view text, std::size_t at) {
    const char quote = text[at];
    const bool long_one = text.substr(at, 3) == std::string(3, quote);
    for (std::size_t i = at + (long_one ? 3 : 1); i < text.size(); ++i) {
        if (text[i] == '\\' && quote == '"') {
            ++i;
        } else if (text[i] == '\n' && !long_one) {
            return i; // never closed
        } else if (text[i] == quote && !long_one) {
            return i + 1;
        } else if (text.substr(i, 3) == std::string(3, quote)) {
            // The closing quotes may be preceded by quotes that belong to the string.
            return std::min(text.find_first_not_of(quote, i), text.size());
        }
    }
    return text.size();
}

/// The line of the first non-ASCII character outside strings and comments, or 0. TOML does not
/// allow them there, and the behaviour of toml++ 3.3 is undefined for some. A quote begins a string
/// only where a value or a key begins; elsewhere it would hide the letters behind it. After a
/// point, where "1.'x'" cannot be told from a key, letters are not allowed even in quotes.
int line_of_foreign_letter(std::string_view text) {
    constexpr std::string_view before_strings = " \t\r\n=[{,";
    const auto is_foreign = [](char c) { return static_cast<unsigned char>(c) >= 0x80; };
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    int line = 1;
    if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
    std::size_t at = 0;
    while (at < text.size()) {
        std::size_t next = at + 1;
        if (text[at] == '#') next = std::min(text.find('\n', at), text.size());
        const char previous = at == 0 ? '\n' : text[at - 1];
        const bool after_point = previous == '.';
        if ((text[at] == '"' || text[at] == '\'') &&
            (after_point || before_strings.find(previous) != std::string_view::npos))
            next = end_of_string(text, at);
        if (is_foreign(text[at])) return line;
        if (after_point && std::ranges::any_of(text.substr(at, next - at), is_foreign)) return line;
        line +=
            static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(at),
                                        text.begin() + static_cast<std::ptrdiff_t>(next), '\n'));
        at = next;
    }
    return 0;
}

/// "1.5" if the parser stopped at or after the comma of "1,5" behind the equals sign of a key;
/// otherwise nothing. In an array, a comma separates elements.
std::optional<std::string> decimal_comma_at(std::string_view text,
                                            const toml::source_position& at) {
    std::size_t start = 0;
    for (toml::source_index line = 1; line < at.line; ++line) {
        const std::size_t end = text.find('\n', start);
        if (end == std::string_view::npos) return std::nullopt;
        start = end + 1;
    }
    const std::string_view line = text.substr(start, text.find('\n', start) - start);
    const std::size_t comma = line.rfind(',', at.column > 0 ? at.column - 1 : 0);
    if (comma == std::string_view::npos || comma == 0) return std::nullopt;
    const std::string_view key = line.substr(0, comma);
    const std::size_t value = key.rfind('=');
    if (value == std::string_view::npos || key.find('[', value) != std::string_view::npos)
        return std::nullopt;
    constexpr std::string_view number = "+-0123456789.eE";
    const std::size_t before = line.find_last_not_of(number, comma - 1) + 1;
    const std::size_t after = std::min(line.find_first_not_of(number, comma + 1), line.size());
    const std::size_t next = std::min(line.find_first_not_of(" \t", after), line.size());
    if (before > comma || next + 1 < at.column) return std::nullopt; // another key follows
    return with_decimal_point(line.substr(before, after - before));
}

} // namespace

NodePtr parse_toml(std::string_view text, const std::string& file_name,
                   DiagnosticList& diagnostics) {
    const auto file = std::make_shared<const std::string>(file_name);
    if (const int line = line_of_endless_key(text)) {
        diagnostics.error(
            {file, line, 1},
            fmt::format("this key has more than {} parts separated by dots", most_levels));
        return nullptr;
    }
    if (const int line = line_of_foreign_letter(text)) {
        diagnostics.error(
            {file, line, 1},
            "non-ASCII character or invalid byte outside of quotes and comments; write "
            "keys and values as in docs/reference/job-file.md");
        return nullptr;
    }
    try {
        const toml::table table = toml::parse(text, file_name);
        Converter converter(file, diagnostics);
        return make_node(std::get<TableNode>(converter.convert(table, 0)->value), {file, 0, 0});
    } catch (const toml::parse_error& problem) {
        // toml++ reports a corrupted name for a duplicate key.
        const bool again = problem.description().find("cannot redefine") != std::string_view::npos;
        const bool is_divided =
            problem.description().find("inline table") != std::string_view::npos &&
            problem.description().find("'\\n'") != std::string_view::npos;
        const auto number = decimal_comma_at(text, problem.source().begin);
        if (number)
            diagnostics.error(place(problem.source(), file),
                              fmt::format("write decimal numbers with a point: {}", *number));
        else if (is_divided)
            diagnostics.error(place(problem.source(), file),
                              "a table in braces continues on the next line, which TOML 1.1 "
                              "permits and TOML 1.0 does not; write it on one line");
        else
            diagnostics.error(
                place(problem.source(), file),
                again ? "duplicate key: a table may contain a key only once (in [sweep], keys that "
                        "change together belong in zip)"
                      : fmt::format("this is not valid TOML: {}",
                                    excerpt(problem.description(), 200)));
        return nullptr;
    }
}

} // namespace shearwake::config
