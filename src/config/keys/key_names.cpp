// SPDX-License-Identifier: BSD-3-Clause
#include "config/keys/key_names.hpp"

#include "base/text.hpp"
#include "config/keys/schema.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake::config {
namespace {

constexpr std::size_t most_suggestions = 3;
constexpr std::size_t longest_ending = 60;

/// Adds the keys that a table of the schema describes.
void add_keys(const nlohmann::ordered_json& table, const std::string& prefix,
              std::vector<std::string>& keys) {
    if (!table.is_object()) return;
    const auto properties = table.find("properties");
    if (properties == table.end()) return;
    for (const auto& [name, content] : properties->items()) {
        keys.push_back(prefix + name);
        add_keys(content, prefix + name + ".", keys);
        if (const auto items = content.find("items"); items != content.end())
            add_keys(*items, prefix + name + "[1].", keys);
    }
}

/// What follows the last dot.
std::string last_word(const std::string& key) {
    return key.substr(key.rfind('.') + 1);
}

std::vector<std::string> keys_that_end_in(const std::string& ending,
                                          const std::vector<std::string>& keys) {
    std::vector<std::string> found;
    for (const std::string& key : keys)
        if (key.ends_with("." + ending)) found.push_back(key);
    return found;
}

} // namespace

std::vector<std::string> key_names() {
    std::vector<std::string> keys;
    add_keys(nlohmann::ordered_json::parse(job_schema()), "", keys);
    return keys;
}

std::string full_key_hint(std::string_view ending) {
    if (ending.size() > longest_ending) return "";
    const std::vector<std::string> keys = key_names();
    std::vector<std::string> meant = keys_that_end_in(std::string(ending), keys);
    if (meant.empty() && ending.find('.') == std::string_view::npos) {
        std::vector<std::string> words;
        for (const std::string& key : keys)
            words.push_back(key.find('.') == std::string::npos ? key : last_word(key));
        const auto word = nearest(ending, words);
        if (!word || std::ranges::find(keys, *word) != keys.end()) return ""; // a table
        meant = keys_that_end_in(*word, keys);
    }
    if (meant.empty() || meant.size() > most_suggestions) return "";
    return fmt::format("did you mean {}?", fmt::join(meant, " or "));
}

} // namespace shearwake::config
