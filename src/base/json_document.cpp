// SPDX-License-Identifier: BSD-3-Clause
#include "base/json_document.hpp"

#include <nlohmann/json.hpp>

namespace shearwake {

std::string json_document(std::string_view command, const nlohmann::ordered_json& members) {
    using Json = nlohmann::ordered_json;
    Json document = {{"schema", json_schema_version}, {"command", command}};
    document.update(members);
    return document.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

} // namespace shearwake
