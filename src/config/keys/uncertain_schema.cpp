// SPDX-License-Identifier: BSD-3-Clause
#include "config/keys/uncertain_schema.hpp"

#include "sampling/design.hpp"

#include <nlohmann/json.hpp>

namespace shearwake::config {
namespace {

using Json = nlohmann::ordered_json;

} // namespace

nlohmann::ordered_json uncertain_schema() {
    const Json number = {{"type", "number"}}, word = {{"type", "string"}};
    const Json pair = {{"type", "array"}, {"items", word}, {"minItems", 2}, {"maxItems", 2}};
    const Json correlation = {{"type", "object"},
                              {"properties", {{"keys", pair}, {"rank", number}}},
                              {"required", {"keys", "rank"}},
                              {"additionalProperties", false}};
    return {{"type", "object"},
            {"properties",
             {{"samples", {{"type", "integer"}, {"minimum", 2}}},
              {"sampling", {{"enum", sampling::sampling_names()}}},
              {"analysis", {{"enum", sampling::analysis_names()}}},
              {"seed", {{"type", "integer"}, {"minimum", 0}}},
              {"correlation", {{"type", "array"}, {"items", correlation}}},
              {"exceedance", {{"type", "object"}, {"additionalProperties", number}}}}},
            {"additionalProperties", {{"type", "object"}}},
            {"required", {"samples"}},
            {"description", "uncertain keys in full, each with its distribution"}};
}

} // namespace shearwake::config
