// SPDX-License-Identifier: BSD-3-Clause
#include "config/keys/schema_types.hpp"

#include "base/text.hpp"
#include "config/document/key_range.hpp"

#include <cmath>

namespace shearwake::config {

Json number(const Field& field) {
    const auto [range, least_size, why] = key_range(field.key, field.range);
    Json type = {{"type", "number"}};
    if (std::isfinite(range.least))
        type[range.least_excluded ? "exclusiveMinimum" : "minimum"] = range.least;
    if (std::isfinite(range.most))
        type[range.most_excluded ? "exclusiveMaximum" : "maximum"] = range.most;
    if (least_size > 0.0) {
        type["anyOf"] = {{{"minimum", 0}, {"maximum", 0}}, {{"minimum", least_size}}};
        if (range.least < 0.0) type["anyOf"].push_back({{"maximum", -least_size}});
    }
    return type;
}

Json integer(const Field& field) {
    Json type = number(field);
    type["type"] = "integer";
    return type;
}

Json list_of(const Json& item, std::size_t least, std::size_t most) {
    Json type = {{"type", "array"}, {"items", item}};
    if (least > 0) type["minItems"] = least;
    if (most > 0) type["maxItems"] = most;
    return type;
}

Json one_of(const std::vector<std::string>& words) {
    return {{"enum", words}};
}

Json named_type(const Field& field) {
    const std::string type = field.type;
    Json point = list_of(number(field), 2, 2);
    if (type.starts_with("word:")) return one_of(words_of(field));
    if (type.starts_with("point or word:")) return {{"anyOf", {point, one_of(words_of(field))}}};
    if (type == "word" || type == "file") return {{"type", "string"}};
    if (type == "name")
        return {{"type", "string"},
                {"pattern", "^[A-Za-z0-9_][A-Za-z0-9._-]*$"},
                {"maxLength", longest_file_name}};
    if (type == "words") return list_of({{"type", "string"}});
    if (type == "pair of words") return list_of({{"type", "string"}}, 2, 2);
    if (type == "table") return {{"type", "object"}};
    if (type == "tables") return list_of({{"type", "object"}});
    if (type == "table of numbers")
        return {{"type", "object"}, {"additionalProperties", number(field)}};
    if (type == "number") return number(field);
    if (type == "integer") return integer(field);
    if (type == "boolean") return {{"type", "boolean"}};
    if (type == "point") return point;
    if (type == "point or triple") return list_of(number(field), 2, 3);
    if (type == "triple") return list_of(number(field), 3, 3);
    if (type == "ends and count")
        return {{"type", "array"},
                {"prefixItems", {number({}), number({}), integer(field)}},
                {"minItems", 3},
                {"maxItems", 3}};
    if (type == "points") return list_of(point, field.least_count, field.most_count);
    if (type == "path") return {{"$ref", "#/$defs/path"}};
    return Json::object();
}

} // namespace shearwake::config
