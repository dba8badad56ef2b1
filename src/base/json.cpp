// SPDX-License-Identifier: BSD-3-Clause
#include "base/json.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <nlohmann/json.hpp>

namespace shearwake {

std::string json_string(std::string_view text) {
    // A value that is not a container is destroyed without memory.
    using nlohmann::json;
    return json(std::string(text)).dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string json_number(double value) {
    return nlohmann::json(value).dump();
}

std::string json_array(const std::vector<std::string>& elements) {
    return fmt::format("[{}]", fmt::join(elements, ","));
}

JsonLine& JsonLine::add(std::string_view name, const std::vector<std::string>& values) {
    std::vector<std::string> elements;
    std::ranges::transform(values, std::back_inserter(elements), json_string);
    return add_json(name, json_array(elements));
}

JsonLine& JsonLine::add_json(std::string_view name, std::string_view json) {
    if (members_.size() > 1) members_ += ',';
    members_ += json_string(name);
    members_ += ':';
    members_ += json;
    return *this;
}

std::string json_document(std::string_view command, const nlohmann::ordered_json& members) {
    using Json = nlohmann::ordered_json;
    Json document = {{"schema", json_schema_version}, {"command", command}};
    document.update(members);
    return document.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

} // namespace shearwake
