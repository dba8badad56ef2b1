// SPDX-License-Identifier: BSD-3-Clause
#include "base/json.hpp"
#include "config/keys/key_table.hpp"

#include "base/units.hpp"
#include "config/document/job_keys.hpp"
#include "config/document/key_range.hpp"
#include "config/document/presets.hpp"
#include "config/document/tree.hpp"
#include "config/keys/schema_types.hpp"
#include "config/sections/read_case.hpp"
#include "problem/case/afferents.hpp"
#include "problem/case/case_fields.hpp"
#include "problem/case/optimise_options.hpp"

#include <fmt/format.h>

namespace shearwake::config {
namespace {

/// The member in which a table under construction lists the keys that are required in a job without
/// a sweep. In a job with a sweep, the sweep may give them instead.
constexpr const char* required_keys = "required without a sweep";

Json object() {
    return {{"type", "object"}, {"properties", Json::object()}, {"unevaluatedProperties", false}};
}

/// The table of a dotted key, created if necessary, and the last part of the key.
std::pair<Json*, std::string> place_of(Json& table, const std::string& key) {
    const std::size_t dot = key.find('.');
    if (dot == std::string::npos) return {&table, key};
    Json& below = table["properties"][key.substr(0, dot)];
    if (below.is_null()) below = object();
    return place_of(below, key.substr(dot + 1));
}

/// A walk that describes the keys of the current table.
class SchemaWalk {
public:
    explicit SchemaWalk(Json& root) : root_(root), table_(&root) {}

    template <class T>
    void operator()(const T& value, const Field& field) {
        if (!*field.key) return;
        Json type = *field.type ? named_type(field) : type_of(value, field);
        if (field.given == Given::automatic) type = {{"anyOf", {type, {{"const", "auto"}}}}};
        if (field.given == Given::optional && !*field.fallback)
            if (Json fallback = shown(value, field.key); !fallback.is_null())
                type["default"] = std::move(fallback);
        put(field, std::move(type));
    }

    template <class T>
    void key(const T& example, const Field& field) {
        (*this)(example, field);
    }

    void key(const Field& field) {
        Json type = named_type(field);
        with_inline_table(field, [&](const auto& keys) {
            type = object();
            SchemaWalk walk(type);
            walk_fields(walk, keys);
        });
        put(field, std::move(type));
    }

    template <class... T>
    void choice(const std::variant<T...>& value, const Field& field) {
        const std::string key = field.key;
        const auto each_of = [&](const auto& use) {
            for_each_alternative(std::type_identity<std::variant<T...>>{}, use);
        };
        if (key.empty()) return each_of([&](const auto& a) { walk_optional(a); });
        std::vector<std::string> names = words_of(field);
        if (names.empty()) names = {name_in_jobs<T>()...};
        const auto place = place_of(*table_, key); // a lambda may not capture structured bindings
        Json type = one_of(names);
        std::string first = names.front();
        if (!*field.fallback && field.given == Given::optional) {
            std::visit([&](const auto& a) { first = name_in_jobs<std::decay_t<decltype(a)>>(); },
                       value);
            type["default"] = first;
        }
        put(field, std::move(type));
        each_of([&](const auto& a) { alternative(*place.first, place.second, first, a, field); });
    }

    template <class T>
    void each(const char* table, const std::vector<T>&, const Field& field) {
        Json item = object();
        SchemaWalk walk(item);
        const T example = Example<T>::make();
        if constexpr (requires { example.valueless_by_exception(); })
            walk.choice(example, field);
        else
            walk_fields(walk, example);
        const auto [owner, name] = place_of(root_, table);
        (*owner)["properties"][name] = list_of(item, 0);
    }

    template <class T>
    void maybe(const char* table, const std::optional<T>&) {
        section(table);
        const T example = Example<T>::make();
        walk_fields(*this, example);
    }

    /// The shapes that exist only in job files, in the table of a path.
    void shapes() {
        for_each_alternative(std::type_identity<PathShapes>{}, [&](const auto& shape) {
            alternative(root_, "shape", "", shape, {});
        });
    }

    void section(const char* table) {
        const auto [owner, name] = place_of(root_, table);
        Json& made = (*owner)["properties"][name];
        if (made.is_null()) made = object();
        table_ = &made;
    }

private:
    void put(const Field& field, Json type) {
        const auto [table, name] = place_of(*table_, field.key);
        std::string meaning = field.meaning;
        if (const auto unit = unit_of(field.key))
            meaning += fmt::format(" [{}]", unit->suffix.substr(1));
        if (*field.only_with) meaning = fmt::format("with {}: {}", field.only_with, meaning);
        type["description"] = meaning;
        (*table)["properties"][name] = std::move(type);
        const bool required = field.given == Given::required || field.given == Given::preset;
        if (required && field.applies && !optional_) (*table)[required_keys].push_back(name);
    }

    template <class Alternative>
    void walk_optional(const Alternative& a) {
        const bool before = std::exchange(optional_, true);
        walk_fields(*this, a);
        optional_ = before;
    }

    /// The keys of one alternative: in a table with its name, or allowed if `key` selects it.
    template <class Alternative>
    void alternative(Json& table, const std::string& key, const std::string& first,
                     const Alternative& a, const Field& field) {
        const std::string name = name_in_jobs<Alternative>();
        Json keys = {{"properties", Json::object()}};
        Json* const before = std::exchange(table_, &keys);
        walk_fields(*this, a);
        table_ = before;
        if (keys["properties"].empty()) return;
        if (field.own_tables) {
            keys["type"] = "object";
            keys["unevaluatedProperties"] = false;
            table["properties"][name] = std::move(keys);
            return;
        }
        Json when = {{"properties", {{key, {{"const", name}}}}}};
        if (name != first) when["required"] = Json::array({key});
        table["allOf"].push_back({{"if", std::move(when)}, {"then", std::move(keys)}});
    }

    Json& root_;
    Json* table_;
    bool optional_ = false;
};

/// The part of a schema that applies only to jobs without a sweep; removes the lists from `schema`.
Json extract_requirements(Json& schema) {
    Json rules = Json::object();
    if (const Json* list = schema.find(required_keys)) {
        if (schema.contains("properties") && schema["properties"].contains("preset"))
            rules["anyOf"] = {{{"required", {"preset"}}}, {{"required", *list}}};
        else
            rules["required"] = *list;
        schema.erase(required_keys);
    }
    if (schema.contains("properties"))
        for (auto& [key, below] : schema["properties"].items())
            if (Json found = extract_requirements(below); !found.empty())
                rules["properties"][key] = std::move(found);
    if (schema.contains("items"))
        if (Json found = extract_requirements(schema["items"]); !found.empty())
            rules["items"] = std::move(found);
    for (const char* list : {"allOf", "anyOf"})
        if (schema.contains(list))
            for (Json& part : schema[list]) {
                Json& below = part.contains("then") ? part["then"] : part;
                Json found = extract_requirements(below);
                if (found.empty()) continue;
                const Json when = part.contains("if") ? part["if"] : Json{{"type", "object"}};
                rules["allOf"].push_back({{"if", when}, {"then", std::move(found)}});
            }
    return rules;
}

/// Requires the listed keys of a table and of its tables also in a job with a sweep.
void require_always(Json& table) {
    if (const Json* list = table.find(required_keys)) {
        Json required = *list; // its place may change
        table.erase(required_keys);
        table["required"] = std::move(required);
    }
    if (!table.contains("properties")) return;
    for (auto& [key, below] : table["properties"].items())
        require_always(below.contains("items") ? below["items"] : below);
}

/// Adds a table of a job that is not one of a case.
template <class Keys>
Json& add_table(Json& root, const char* name) {
    SchemaWalk walk(root);
    walk.section(name);
    const Keys keys;
    walk_fields(walk, keys);
    Json& table = root["properties"][name];
    require_always(table);
    return table;
}

/// The value of a full key in [sweep] or [uncertain]: a table with one of the keys `marks`, or a
/// table of keys that continue this one; the latter are described by the same entry of $defs.
template <class Keys>
Json value_of_key(const std::string& entry, const std::vector<std::string>& marks) {
    Json described = object();
    SchemaWalk walk(described);
    const Keys keys;
    walk_fields(walk, keys);
    for (const std::string& mark : marks)
        described["anyOf"].push_back({{"required", Json::array({mark})}});
    const Json longer_keys = {{"type", "object"},
                              {"propertyNames", {{"not", one_of(marks)}}},
                              {"additionalProperties", {{"$ref", "#/$defs/" + entry}}}};
    return {{"anyOf", Json::array({std::move(described), longer_keys})}};
}

/// The tables of a job in addition to those of a case.
void add_job_tables(Json& root) {
    root["properties"]["schema"] = {{"const", 1},
                                    {"description", "version of the format of job files"}};
    add_table<JobTableKeys>(root, "job");
    add_table<TableKeys>(root, "table");
    Json& sweep = add_table<SweepTableKeys>(root, "sweep");
    std::string options;
    for (const auto& [name, type] : sweep["properties"].items())
        options += name + "|";
    sweep["propertyNames"] = {
        {"pattern", fmt::format("^({}({})([.\\[].*)?)$", options, fmt::join(case_tables(), "|"))}};
    sweep.erase("unevaluatedProperties");
    sweep["additionalProperties"] = {{"$ref", "#/$defs/axis"}};
    sweep["description"] = "keys in full, each with a list of values or one of linspace, logspace, "
                           "range, refine and find";
    Json& uncertain = add_table<UncertainTableKeys>(root, "uncertain");
    uncertain.erase("unevaluatedProperties");
    uncertain["additionalProperties"] = {{"$ref", "#/$defs/distribution"}};
    uncertain["description"] = "uncertain keys in full, each with its distribution";
}

Json json_of(const Node& node) {
    return std::visit(overloaded{
                          [](const DateNode&) { return Json(); },
                          [](const ListNode& list) {
                              Json array = Json::array();
                              for (const NodePtr& item : list)
                                  array.push_back(json_of(*item));
                              return array;
                          },
                          [](const TableNode& table) {
                              Json members = Json::object();
                              for (const Entry& entry : table.entries)
                                  members[entry.key] = json_of(*entry.value);
                              return members;
                          },
                          [](const auto& value) { return Json(value); },
                      },
                      node.value);
}

/// The tables that the presets of [medium] supply, and the properties of the classes of receptors,
/// for programs that show them.
Json medium_presets() {
    Json presets = Json::object();
    for (const std::string& name : preset_names())
        presets[name] = json_of(*medium_preset(name, {}));
    return presets;
}

Json receptor_table() {
    Json table = Json::object();
    for (const ReceptorClass& one : receptor_classes)
        table[one.name] = {{"label", one.label},
                           {"colour", one.colour},
                           {"colour_on_map", one.colour_on_map},
                           {"feels_static", one.feels_static}};
    return table;
}

} // namespace

Json schema_of_jobs() {
    Json root = object();
    root["required"] = {"schema", "job"};
    root[required_keys] = {"medium", "load", "domain", "time"};
    add_job_tables(root);
    SchemaWalk walk(root);
    const Case defaults;
    walk_fields(walk, defaults);
    const OptimiseOptions optimise;
    walk_fields(walk, optimise);

    root["properties"]["medium"]["properties"]["preset"]["x-presets"] = medium_presets();
    root["properties"]["afferents"]["properties"]["classes"]["x-classes"] = receptor_table();
    Json& layer = root["properties"]["medium"]["properties"]["layer"]["items"];
    Json& loss = layer["properties"]["loss"];
    loss = {{"anyOf", {{{"const", "none"}}, Json(loss)}}};

    // A path is described once and used in two places of the modulations.
    Json& modulation = root["properties"]["load"]["properties"]["modulation"]["properties"];
    Json path, travel, path_with_length = {{"$ref", "#/$defs/path"}};
    SchemaWalk longer(path_with_length);
    const PathLengthKeys length;
    walk_fields(longer, length);
    for (Json& part : modulation["trajectory"]["items"]["allOf"])
        if (Json& keys = part["then"]["properties"]; keys.contains("path")) {
            path = keys["path"];
            keys["path"] = path_with_length;
            travel = keys;
        }
    for (const auto& [key, type] : travel.items()) // of speed and corners
        if (!modulation.contains(key)) modulation[key] = type;
    modulation["path"].update(path_with_length);
    SchemaWalk(path).shapes();

    Json rules = extract_requirements(root);
    Json path_rules = extract_requirements(path);
    if (!path_rules.empty()) path["allOf"].push_back(std::move(path_rules));
    Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                   {"title", "Job file of shearwake"}};
    schema.update(root);
    schema["if"] = {{"anyOf", {{{"required", {"sweep"}}}, {{"required", {"uncertain"}}}}}};
    schema["then"] = Json::object();
    schema["else"] = {{"$ref", "#/$defs/complete"}};
    Json axis = value_of_key<AxisKeys>("axis", {"linspace", "logspace", "range", "refine", "find"});
    axis["anyOf"].push_back({{"type", "array"}});
    schema["$defs"] = {{"path", std::move(path)},
                       {"axis", std::move(axis)},
                       {"distribution",
                        value_of_key<DistributionKeys>("distribution", {"distribution", "preset"})},
                       {"complete", std::move(rules)}};
    return schema;
}

} // namespace shearwake::config
