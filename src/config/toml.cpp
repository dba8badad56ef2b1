// toml++ 3.3.0 asserts what "[ =" breaks, and finds the mistake itself one line later: without its
// asserts a build with asserts refuses a bad job instead of ending there.
#define TOML_ASSERT(expression) static_assert(true)

#include "config/tree.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <toml++/toml.h>
#include <tuple>

namespace shearwake {
namespace {

constexpr int most_levels = 64;

Place place(const toml::source_region& region, const std::shared_ptr<const std::string>& file) {
    return {file, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

/// Turns toml++ nodes into ours.
class Converter {
public:
    Converter(std::shared_ptr<const std::string> file, Diagnostics& findings)
        : file_(std::move(file)), findings_(findings) {}

    NodePtr convert(const toml::node& node, int level) {
        const Place at = place(node.source(), file_);
        if (level > most_levels) {
            findings_.error(at, fmt::format("nested deeper than {} levels", most_levels));
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
        // toml++ keeps its keys by name.
        std::stable_sort(out.entries.begin(), out.entries.end(), [](const auto& a, const auto& b) {
            return std::tie(a.key_at.line, a.key_at.column) <
                   std::tie(b.key_at.line, b.key_at.column);
        });
        return out;
    }

    std::shared_ptr<const std::string> file_;
    Diagnostics& findings_;
};

bool is_key_character(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return std::isalnum(byte) || c == '_' || c == '-' || c == '"' || c == '\'' || byte >= 0x80;
}

/// The line of the first dotted key with more than `most_levels` parts, or 0. The parser nests as
/// deep as such a key says, and frees what it nested by recursion.
int line_of_endless_key(std::string_view text) {
    int line = 1, parts = 0;
    char previous = '\n'; // the last character that is no blank
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

/// The end of the string that begins at `at` with its quotes.
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
            // Quotes that belong to the string may stand before the closing ones.
            return std::min(text.find_first_not_of(quote, i), text.size());
        }
    }
    return text.size();
}

/// The line of the first letter beyond ASCII that stands in no string and no comment, or 0. TOML
/// has none there, and toml++ 3.3 is undefined for some.
int line_of_foreign_letter(std::string_view text) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    int line = 1;
    std::size_t at = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
    while (at < text.size()) {
        std::size_t next = at + 1;
        if (text[at] == '#') next = std::min(text.find('\n', at), text.size());
        if (text[at] == '"' || text[at] == '\'') next = end_of_string(text, at);
        if (static_cast<unsigned char>(text[at]) >= 0x80) return line;
        line +=
            static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(at),
                                        text.begin() + static_cast<std::ptrdiff_t>(next), '\n'));
        at = next;
    }
    return 0;
}

} // namespace

NodePtr parse_toml(std::string_view text, const std::string& file_name, Diagnostics& findings) {
    const auto file = std::make_shared<const std::string>(file_name);
    if (const int line = line_of_endless_key(text)) {
        findings.error({file, line, 1},
                       fmt::format("a key of more than {} parts, joined by dots", most_levels));
        return nullptr;
    }
    if (const int line = line_of_foreign_letter(text)) {
        findings.error({file, line, 1}, "a letter beyond ASCII (or a byte that is none) outside of "
                                        "quotes and comments: write keys and words as in "
                                        "docs/job-file.md");
        return nullptr;
    }
    try {
        const toml::table table = toml::parse(text, file_name);
        Converter converter(file, findings);
        return make_node(std::get<TableNode>(converter.convert(table, 0)->value), {file, 0, 0});
    } catch (const toml::parse_error& problem) {
        // toml++ garbles the key's name where it is given a second time.
        const bool again = problem.description().find("cannot redefine") != std::string_view::npos;
        findings.error(
            place(problem.source(), file),
            again ? "this key stands in its table already: a key is given once (keys of "
                    "one axis go together in zip)"
                  : fmt::format("this is no TOML: {}", excerpt(problem.description(), 200)));
        return nullptr;
    }
}

} // namespace shearwake
