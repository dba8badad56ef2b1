// SPDX-License-Identifier: BSD-3-Clause
#include "config/keys/key_table.hpp"
#include "config/keys/schema_types.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace shearwake::config {
namespace {

// Language servers of TOML do not evaluate unevaluatedProperties. Therefore each table lists the
// keys of all its alternatives and allows no others, and each alternative forbids the keys that
// only others have.

struct KeyAlternative {
    std::string selector, name; // the key that selects it, and its value
    Json* keys = nullptr;
};

std::vector<KeyAlternative> alternatives_of(Json& table) {
    std::vector<KeyAlternative> found;
    if (!table.contains("allOf")) return found;
    for (Json& rule : table["allOf"]) {
        if (!rule.contains("then") || !rule["if"].contains("properties")) continue;
        const auto& when = rule["if"]["properties"].items();
        if (when.size() == 1 && when[0].value.contains("const"))
            found.push_back(
                {when[0].key, when[0].value.at("const").get<std::string>(), &rule["then"]});
    }
    return found;
}

/// Appends the descriptions of all keys of a table to the lists in `found`.
void collect_keys(Json& table, Json& found) {
    if (!table.contains("properties")) return;
    for (const auto& [key, type] : table["properties"].items())
        found[key].push_back(type);
    for (const KeyAlternative& alternative : alternatives_of(table))
        collect_keys(*alternative.keys, found);
}

std::set<std::string> keys_of(Json& table) {
    Json found = Json::object();
    collect_keys(table, found);
    std::set<std::string> keys;
    for (const auto& [key, types] : found.items())
        keys.insert(key);
    return keys;
}

/// Adds the alternatives that have no keys of their own, so that they too can forbid keys.
void add_empty_alternatives(Json& table) {
    std::map<std::string, std::set<std::string>> names;
    for (const KeyAlternative& alternative : alternatives_of(table))
        names[alternative.selector].insert(alternative.name);
    for (const auto& [selector, known] : names) {
        const Json& type = table["properties"][selector];
        if (!type.contains("enum")) continue;
        const Json &words = type.at("enum"), *usual = type.find("default"),
                   &first = usual ? *usual : words.at(0);
        for (const Json& name : words) {
            if (known.contains(name.get<std::string>())) continue;
            Json when = {{"properties", {{selector, {{"const", name}}}}}};
            if (name != first) when["required"] = Json::array({selector});
            table["allOf"].push_back({{"if", when}, {"then", {{"properties", Json::object()}}}});
        }
    }
}

/// Lets each alternative of a table forbid the keys that only others of the same selector have.
void forbid_keys_of_others(Json& table) {
    add_empty_alternatives(table);
    const std::vector<KeyAlternative> alternatives = alternatives_of(table);
    std::vector<std::set<std::string>> keys;
    for (const KeyAlternative& alternative : alternatives)
        keys.push_back(keys_of(*alternative.keys));
    for (std::size_t i = 0; i < alternatives.size(); ++i) {
        std::set<std::string> allowed = keys[i], others;
        for (const auto& [key, type] : table["properties"].items())
            allowed.insert(key);
        for (std::size_t j = 0; j < alternatives.size(); ++j)
            (alternatives[j].selector == alternatives[i].selector ? others : allowed)
                .insert(keys[j].begin(), keys[j].end());
        for (const std::string& key : others)
            if (!allowed.contains(key)) (*alternatives[i].keys)["properties"][key] = false;
    }
}

/// A key of several alternatives: one of their types, described by all of them.
Json union_of(const Json& types) {
    Json distinct = Json::array(), plain = Json::array();
    std::string meaning;
    for (const Json& type : types) {
        Json undescribed = type;
        undescribed.erase("description");
        undescribed.erase("default");
        if (const std::string text = type.value("description", std::string());
            meaning.find(text) == meaning.npos)
            meaning += (meaning.empty() ? "" : "; ") + text;
        if (std::ranges::find(plain, undescribed) != plain.end()) continue;
        plain.push_back(undescribed);
        distinct.push_back(type);
    }
    Json type = distinct.at(0);
    if (distinct.size() > 1) type = {{"anyOf", distinct}};
    type["description"] = meaning;
    return type;
}

void for_each_part(Json& schema, void (&use)(Json&)) {
    if (schema.is_array()) std::ranges::for_each(schema, use);
    if (schema.is_object())
        for (auto& [key, part] : schema.items())
            use(part);
}

/// Closes the tables of a schema by additionalProperties.
void close_tables(Json& schema) {
    for_each_part(schema, close_tables);
    if (!schema.contains("unevaluatedProperties")) return;
    schema.erase("unevaluatedProperties");
    Json found = Json::object();
    collect_keys(schema, found);
    forbid_keys_of_others(schema);
    for (const auto& [key, types] : found.items())
        if (!schema["properties"].contains(key)) schema["properties"][key] = union_of(types);
    schema["additionalProperties"] = false;
}

/// States that parts of schemas, such as conditions, allow other keys: some language servers assume
/// the contrary.
void open_parts(Json& schema) {
    const bool describes_table = schema.contains("required") || schema.contains("properties") ||
                                 (schema.contains("type") && schema.at("type") == "object");
    if (describes_table && !schema.contains("additionalProperties"))
        schema["additionalProperties"] = true;
    if (!schema.is_object()) return for_each_part(schema, open_parts);
    for (auto& [key, part] : schema.items())
        key == "properties" ? for_each_part(part, open_parts) : open_parts(part);
}

/// The schema in draft 7, which ignores what stands beside $ref.
Json in_draft_7(const Json& schema) {
    if (!schema.is_structured()) return schema;
    Json converted = schema.is_array() ? Json::array() : Json::object();
    if (schema.is_array()) {
        for (const Json& part : schema)
            converted.push_back(in_draft_7(part));
        return converted;
    }
    for (const auto& [key, part] : schema.items())
        if (key == "$ref")
            converted[key] = "#/definitions/" + part.get<std::string>().substr(8);
        else
            converted[key == "$defs"         ? "definitions"
                      : key == "prefixItems" ? "items"
                                             : key] = in_draft_7(part);
    if (converted.contains("$ref") && converted.size() > 1) {
        converted["allOf"] = Json::array({{{"$ref", converted["$ref"]}}});
        converted.erase("$ref");
    }
    return converted;
}

} // namespace

std::string job_schema(Draft draft) {
    Json schema = schema_of_jobs();
    close_tables(schema);
    open_parts(schema);
    if (draft == Draft::draft_7) {
        schema = in_draft_7(schema);
        schema["$schema"] = "http://json-schema.org/draft-07/schema#";
    }
    return schema.dump(2) + "\n";
}

} // namespace shearwake::config
