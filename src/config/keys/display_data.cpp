// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/presets.hpp"
#include "config/document/tree.hpp"
#include "config/keys/key_table.hpp"
#include "problem/case/afferents.hpp"

#include <nlohmann/json.hpp>

namespace shearwake::config {
namespace {

using Json = nlohmann::ordered_json;

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

} // namespace

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

} // namespace shearwake::config
