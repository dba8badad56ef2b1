// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/reader.hpp"

#include "base/text.hpp"
#include "base/units.hpp"
#include "config/document/key_range.hpp"
#include "config/document/presets.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {

namespace {

/// Converts `value` from the unit of `key` to SI. Divides where possible: 49 / 1000 is the double
/// closest to 0.049, while 49 * 0.001 is not.
double to_SI(std::string_view key, double value) {
    const auto unit = unit_of(key);
    if (!unit) return value;
    const double divisor = std::round(1.0 / unit->to_SI);
    const bool divides = divisor >= 10.0 && std::abs(divisor * unit->to_SI - 1.0) < 1e-12;
    return divides ? value / divisor : value * unit->to_SI;
}

/// The allowed word with the meaning of `word`.
std::optional<std::string> synonym(std::string_view word, std::span<const std::string> allowed) {
    static constexpr std::pair<std::string_view, std::string_view> synonyms[] = {
        {"sphere", "ellipsoid"}, {"ball", "ellipsoid"}, {"spheroid", "ellipsoid"},
        {"cube", "box"},         {"cuboid", "box"},     {"rod", "cylinder"},
        {"tube", "cylinder"},    {"gauss", "gaussian"},
    };
    for (const auto& [other, name] : synonyms)
        if (other == word && std::ranges::find(allowed, name) != allowed.end())
            return std::string(name);
    return std::nullopt;
}

} // namespace

Reader::Reader(NodePtr table, std::string path, DiagnosticList& diagnostics)
    : table_(std::move(table)), path_(std::move(path)), diagnostics_(&diagnostics) {
    if (table_ && !std::holds_alternative<TableNode>(table_->value)) table_ = nullptr;
}

NodePtr Reader::node(std::string_view key) {
    known_.emplace_back(key);
    if (!table_) return nullptr;
    const Entry* entry = std::get<TableNode>(table_->value).find(key);
    return entry ? entry->value : nullptr;
}

bool Reader::has(std::string_view key) {
    return node(key) != nullptr;
}

std::vector<std::string> Reader::keys() const {
    std::vector<std::string> keys;
    if (table_)
        if (const auto* table = std::get_if<TableNode>(&table_->value))
            for (const Entry& entry : table->entries)
                keys.push_back(entry.key);
    return keys;
}

// ---- Numbers ------------------------------------------------------------------------------------

std::optional<double> Reader::checked(std::string_view key, const Node& node,
                                      const Range& range) const {
    const auto value = as_number(node);
    if (!value) {
        wrong_kind(key, "a number", node);
        return std::nullopt;
    }
    const KeyRange allowed = key_range(key, range);
    if (std::isfinite(*value) && allowed.contains(*value)) return to_SI(key, *value);
    std::string more;
    if (range.contains(*value)) {
        more = fmt::format(": {}", allowed.why);
    } else if (*value == 0.0) {
        const Entry* kind = std::get<TableNode>(table_->value).find("kind");
        const auto* word = kind ? std::get_if<std::string>(&kind->value->value) : nullptr;
        const std::string_view hint = instead_of_zero(key, word ? *word : std::string_view());
        if (!hint.empty()) more = fmt::format("; {}", hint);
    }
    diagnostics_->error(node.at, fmt::format("{} must be {}, but is {}{}", full(key),
                                             allowed.words(), exact(*value), more));
    return std::nullopt;
}

std::optional<double> Reader::find_number(std::string_view key, const Range& range) {
    const NodePtr found = node(key);
    return found ? checked(key, *found, range) : std::nullopt;
}

double Reader::number_or(std::string_view key, double fallback_SI, const Range& range) {
    return find_number(key, range).value_or(fallback_SI);
}

double Reader::number(std::string_view key, const Range& range) {
    if (!has(key)) missing(key);
    return find_number(key, range).value_or(1.0);
}

std::optional<std::vector<double>> Reader::find_numbers(std::string_view key, const Range& range) {
    const ListNode* items = list(key, "a list of numbers");
    if (!items) return std::nullopt;
    std::vector<double> numbers;
    for (const NodePtr& item : *items) {
        const auto value = checked(key, *item, range);
        if (!value) return std::nullopt;
        numbers.push_back(*value);
    }
    return numbers;
}

// ---- Words and flags ----------------------------------------------------------------------------

/// Titles and names appear on terminals, in tables and on HTML pages.
bool Reader::is_clean(std::string_view key, const std::string& word, const Node& node) const {
    if (!has_control_characters(word)) return true;
    diagnostics_->error(node.at, fmt::format("{} contains a control character: \"{}\"", full(key),
                                             excerpt(printable(word))));
    return false;
}

std::optional<std::string> Reader::find_word(std::string_view key) {
    const NodePtr found = node(key);
    if (!found) return std::nullopt;
    const auto* word = std::get_if<std::string>(&found->value);
    if (!word) wrong_kind(key, "a string", *found);
    if (!word || !is_clean(key, *word, *found)) return std::nullopt;
    return *word;
}

std::string Reader::word(std::string_view key) {
    if (!has(key)) missing(key);
    return find_word(key).value_or("");
}

std::optional<std::string> Reader::find_choice(std::string_view key,
                                               std::span<const std::string> allowed) {
    const auto word = find_word(key);
    if (!word || std::find(allowed.begin(), allowed.end(), *word) != allowed.end()) return word;
    const auto other_name = synonym(*word, allowed);
    auto misspelled = std::optional<std::string>();
    if (!other_name && word->size() < 60) misspelled = nearest(*word, allowed);
    const auto meant = other_name ? other_name : misspelled;
    error(key, fmt::format("must be {}{}, but is \"{}\"{}", allowed.size() > 1 ? "one of " : "",
                           quoted_list(allowed), excerpt(*word),
                           meant ? fmt::format("; did you mean \"{}\"?", *meant) : ""));
    is_guessed_ = is_guessed_ || misspelled;
    return misspelled; // a synonym may have other keys
}

std::string Reader::choice_or(std::string_view key, const std::string& fallback,
                              std::span<const std::string> allowed) {
    return find_choice(key, allowed).value_or(fallback);
}

std::string Reader::choice(std::string_view key, std::span<const std::string> allowed) {
    if (!has(key)) missing(key);
    return choice_or(key, allowed.front(), allowed);
}

std::optional<bool> Reader::find_flag(std::string_view key) {
    const NodePtr found = node(key);
    if (!found) return std::nullopt;
    const auto* flag = std::get_if<bool>(&found->value);
    if (!flag) wrong_kind(key, "true or false", *found);
    return flag ? std::optional(*flag) : std::nullopt;
}

std::optional<std::vector<std::string>> Reader::find_words(std::string_view key) {
    const ListNode* items = list(key, "a list of strings");
    if (!items) return std::nullopt;
    std::vector<std::string> words;
    for (const NodePtr& item : *items) {
        const auto* word = std::get_if<std::string>(&item->value);
        if (!word) {
            wrong_kind(key, "a list of strings", *item);
            return std::nullopt;
        }
        if (!is_clean(key, *word, *item)) return std::nullopt;
        words.push_back(*word);
    }
    return words;
}

// ---- Points -------------------------------------------------------------------------------------

std::optional<Vec2> Reader::checked_point(std::string_view key, const Node& node,
                                          const Range& range) const {
    const auto* items = std::get_if<ListNode>(&node.value);
    if (!items || items->size() != 2) {
        if (items)
            diagnostics_->error(
                node.at,
                fmt::format("{} must be a pair [x, y], but has {} values{}", full(key),
                            items->size(),
                            items->size() == 4 ? "; write decimal numbers with a point" : ""));
        else
            wrong_kind(key, "a pair [x, y]", node);
        return std::nullopt;
    }
    const auto x = checked(key, *items->front(), range), y = checked(key, *items->back(), range);
    return x && y ? std::optional(Vec2{*x, *y}) : std::nullopt;
}

Vec2 Reader::point(std::string_view key, const Range& range) {
    const NodePtr found = node(key);
    if (!found) missing(key);
    return (found ? checked_point(key, *found, range) : std::nullopt).value_or(Vec2{1.0, 1.0});
}

Vec2 Reader::point_or(std::string_view key, Vec2 fallback_SI) {
    const NodePtr found = node(key);
    const auto point = found ? checked_point(key, *found, Range::any()) : std::nullopt;
    return point.value_or(fallback_SI);
}

std::optional<std::vector<Vec2>> Reader::find_points(std::string_view key) {
    const ListNode* items = list(key, "a list of points [[x, y], ...]");
    if (!items) return std::nullopt;
    std::vector<Vec2> points;
    for (const NodePtr& item : *items) {
        const auto point = checked_point(key, *item, Range::any());
        if (!point) return std::nullopt;
        points.push_back(*point);
    }
    return points;
}

// ---- Tables -------------------------------------------------------------------------------------

Reader Reader::optional_table(std::string_view key) {
    const NodePtr found = node(key);
    const bool is_table = found && std::holds_alternative<TableNode>(found->value);
    if (found && !is_table) wrong_kind(key, "a table", *found);
    return Reader(is_table ? found : nullptr, full(key), *diagnostics_);
}

Reader Reader::table(std::string_view key) {
    if (!has(key)) missing(key);
    return optional_table(key);
}

std::vector<Reader> Reader::tables(std::string_view key) {
    std::vector<Reader> readers;
    const ListNode* items = list(key, "a list of tables");
    if (!items) return readers;
    for (std::size_t i = 0; i < items->size(); ++i) {
        const NodePtr& item = (*items)[i];
        if (!std::holds_alternative<TableNode>(item->value)) wrong_kind(key, "a table", *item);
        readers.emplace_back(item, fmt::format("{}[{}]", full(key), i + 1), *diagnostics_);
    }
    return readers;
}

const ListNode* Reader::list(std::string_view key, std::string_view wanted) {
    const NodePtr found = node(key);
    if (!found) return nullptr;
    const auto* items = std::get_if<ListNode>(&found->value);
    if (!items) wrong_kind(key, wanted, *found);
    return items;
}

} // namespace shearwake::config
