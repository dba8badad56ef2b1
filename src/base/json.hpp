// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// A string in JSON, with its quotes. Invalid UTF-8 (in paths or system messages) is replaced.
std::string json_string(std::string_view text);

/// A number in JSON, with as many digits as are needed to read the same one; null if it is not
/// finite.
std::string json_number(double value);

/// The elements, which are JSON already, between brackets and commas.
std::string json_array(const std::vector<std::string>& elements);

/// One JSON object as text on one line. The containers of nlohmann-json need memory when they are
/// destroyed, and end the process if there is none. While a case is computed, which can fail alone,
/// JSON is therefore composed as text.
class JsonLine {
public:
    JsonLine& add(std::string_view name, std::string_view value) {
        return add_json(name, json_string(value));
    }
    JsonLine& add(std::string_view name, const char* value) {
        return add(name, std::string_view(value));
    }
    JsonLine& add(std::string_view name, std::floating_point auto value) {
        return add_json(name, json_number(value));
    }
    JsonLine& add(std::string_view name, std::integral auto value) {
        if constexpr (std::same_as<decltype(value), bool>)
            return add_json(name, value ? "true" : "false");
        else
            return add_json(name, std::to_string(value));
    }
    JsonLine& add(std::string_view name, const std::vector<std::string>& values);

    /// With a value that is JSON already.
    JsonLine& add_json(std::string_view name, std::string_view json);

    std::string text() const { return members_ + '}'; }

private:
    std::string members_ = "{";
};

/// Version of the documents that commands print with --json. A change that removes or renames a
/// member, or changes its meaning, increases it. docs/reference/json-output.md describes them.
inline constexpr int json_schema_version = 2;

/// The text of such a document: an object with `schema`, `command`, and then `members`. Numbers
/// that are not finite become null, and invalid UTF-8 is replaced.
std::string json_document(std::string_view command, const nlohmann::ordered_json& members);

} // namespace shearwake
