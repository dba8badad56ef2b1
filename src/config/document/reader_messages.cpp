// SPDX-License-Identifier: BSD-3-Clause
// Messages of Reader about keys: names, locations, unknown and missing keys.
#include "config/document/reader.hpp"

#include "base/text.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <utility>

namespace shearwake::config {
namespace {

/// Words that users try, and the tables of a job that they mean.
constexpr std::array<std::pair<std::string_view, std::string_view>, 15> tables_by_other_names = {
    {{"receptors", "afferents"},
     {"receptor", "afferents"},
     {"fibres", "afferents"},
     {"fibers", "afferents"},
     {"nerves", "afferents"},
     {"neural", "afferents"},
     {"skin", "medium"},
     {"tissue", "medium"},
     {"material", "medium"},
     {"focus", "load"},
     {"pressure", "load"},
     {"source", "load"},
     {"grid", "domain"},
     {"engine", "solver"},
     {"output", "record"}}};

/// Whether each part of `key` between underscores begins the same part of `other`, as in
/// draw_freq_Hz and draw_frequency_Hz.
bool abbreviates(std::string_view key, std::string_view other) {
    while (true) {
        const std::string_view part = key.substr(0, key.find('_'));
        const std::string_view word = other.substr(0, other.find('_'));
        if (!word.starts_with(part) || (part.size() < 2 && part != word)) return false;
        const bool is_last = part.size() == key.size();
        if (is_last || word.size() == other.size()) return is_last && word.size() == other.size();
        key.remove_prefix(part.size() + 1);
        other.remove_prefix(word.size() + 1);
    }
}

} // namespace

bool Reader::has_misspelled(std::string_view key) const {
    constexpr std::size_t shortest = 6, most_letters = 2;
    return std::ranges::any_of(keys(), [&](const std::string& given) {
        if (std::ranges::find(known_, given) != known_.end()) return false;
        return abbreviates(given, key) || without_unit(key) == given ||
               (given.size() >= shortest && given.size() < 60 &&
                edit_distance(given, key) <= most_letters);
    });
}

std::string Reader::full(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

Place Reader::place(std::string_view key) const {
    if (!table_) return {};
    const Entry* entry = std::get<TableNode>(table_->value).find(key);
    return entry ? entry->value->at : table_->at;
}

void Reader::error(std::string_view key, std::string_view message) const {
    diagnostics_->error(place(key), fmt::format("{} {}", full(key), message));
}

void Reader::conflict(std::string_view key, std::string_view message) const {
    diagnostics_->error_once(place(key), fmt::format("{} {}", full(key), message));
}

void Reader::wrong_kind(std::string_view key, std::string_view wanted, const Node& found) const {
    const auto* word = std::get_if<std::string>(&found.value);
    const auto number = word ? with_decimal_point(*word) : std::nullopt;
    diagnostics_->error(
        found.at,
        fmt::format("{} must be {}, but is {}{}{}", full(key), wanted, kind_name(found),
                    word ? fmt::format(" (\"{}\")", excerpt(*word)) : "",
                    number ? fmt::format("; write decimal numbers with a point: {}", *number)
                           : ""));
}

void Reader::missing(std::string_view key) {
    if (std::find(missing_.begin(), missing_.end(), key) == missing_.end())
        missing_.emplace_back(key);
}

void Reader::report_missing(std::string_view key) {
    if (has(key)) return;
    const auto meant = nearest(std::string(key), keys());
    error(key, meant ? fmt::format("is missing; {} is unknown", *meant) : "is missing");
}

std::string Reader::unknown_message(std::string_view key, std::optional<std::string>& meant) const {
    const std::string start = full(excerpt(key)) + " is unknown";
    if (key.size() > 60) return start;
    for (const std::string& required : missing_)
        if (!unit_of(required) && edit_distance(key, required) == 1) {
            meant = required;
            return fmt::format("{}; did you mean {}?", start, required);
        }
    for (const std::string& known : known_) {
        const auto unit = unit_of(known);
        if (!unit || (without_unit(known) != without_unit(key) && without_unit(known) != key))
            continue;
        meant = known;
        return fmt::format("{}; the unit of {} is {}: use {}", start, without_unit(known),
                           unit->suffix.substr(1), known);
    }
    const auto written_out = std::ranges::find_if(
        known_, [&](const std::string& known) { return abbreviates(key, known); });
    meant = written_out != known_.end() ? *written_out : nearest(key, known_);
    if (meant) return fmt::format("{}; did you mean {}?", start, *meant);
    if (!path_.empty()) return start;
    for (const auto& [word, table] : tables_by_other_names)
        if (key == word && std::ranges::find(known_, table) != known_.end()) {
            meant = table;
            return fmt::format("{}; did you mean [{}]?", start, table);
        }
    return start + "; give keys with their tables, as in load.peak_Pa";
}

void Reader::finish() {
    if (!table_) return;
    for (const Entry& entry : std::get<TableNode>(table_->value).entries) {
        if (std::find(known_.begin(), known_.end(), entry.key) != known_.end()) continue;
        std::optional<std::string> meant;
        std::string message;
        if (!diagnostics_->full()) message = unknown_message(entry.key, meant);
        diagnostics_->error(entry.key_at, std::move(message));
        // The same error is not reported twice.
        if (meant) std::erase(missing_, *meant);
        if (meant == "preset") is_guessed_ = true; // it may contain the missing keys
    }
    for (std::size_t i = 0; i < missing_.size() && !is_guessed_; ++i)
        diagnostics_->error(table_->at, fmt::format("{} is missing", full(missing_[i])));
    missing_.clear();
}

} // namespace shearwake::config
