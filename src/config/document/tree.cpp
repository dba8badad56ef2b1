// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/tree.hpp"

#include "base/field.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

const TableNode* as_table(const NodePtr& node) {
    return node ? std::get_if<TableNode>(&node->value) : nullptr;
}

const ListNode* as_list(const NodePtr& node) {
    return node ? std::get_if<ListNode>(&node->value) : nullptr;
}

/// Appends the steps of a segment: "layer[2]" is a key and an index, "layer" a key. Returns false
/// if it is not valid.
bool append_steps(std::string_view segment, Path& path) {
    const std::size_t open = segment.find('[');
    if (open == 0 || segment.empty()) return false;
    path.push_back({std::string(segment.substr(0, open)), 0});
    while (!(segment = segment.substr(std::min(segment.find('['), segment.size()))).empty()) {
        const std::size_t close = segment.find(']');
        if (close == std::string_view::npos) return false;
        std::size_t index = 0;
        const auto end = segment.data() + close;
        const auto [stop, problem] = std::from_chars(segment.data() + 1, end, index);
        if (problem != std::errc() || stop != end || index == 0) return false;
        path.push_back({"", index});
        segment.remove_prefix(close + 1);
        if (!segment.empty() && segment.front() != '[') return false;
    }
    return true;
}

NodePtr with(const NodePtr& node, const Path& path, std::size_t depth, const NodePtr& value,
             const Place& key_at, std::string& problem) {
    if (depth == path.size()) return value;
    const Step& step = path[depth];
    if (step.index > 0) {
        const ListNode* list = as_list(node);
        if (!list || step.index > list->size()) {
            problem = list ? fmt::format("the list has {} entries, counted from 1", list->size())
                           : "there is no list to index";
            return nullptr;
        }
        ListNode changed = *list;
        NodePtr& place = changed[step.index - 1];
        place = with(place, path, depth + 1, value, key_at, problem);
        return place ? make_node(std::move(changed), node->at) : nullptr;
    }
    const TableNode* table = as_table(node);
    if (node && !table) {
        problem = fmt::format("{} is {}, not a table", path[depth - 1].key, kind_name(*node));
        return nullptr;
    }
    TableNode changed = table ? *table : TableNode{};
    const auto entry = std::find_if(changed.entries.begin(), changed.entries.end(),
                                    [&](const Entry& e) { return e.key == step.key; });
    const NodePtr before = entry == changed.entries.end() ? nullptr : entry->value;
    const NodePtr after = with(before, path, depth + 1, value, key_at, problem);
    if (!after) return nullptr;
    if (entry == changed.entries.end())
        changed.entries.push_back({step.key, key_at, after});
    else
        *entry = {step.key, depth + 1 == path.size() ? key_at : entry->key_at, after};
    return make_node(std::move(changed), node ? node->at : key_at);
}

} // namespace

std::optional<double> as_number(const Node& node) {
    if (const auto* integer = std::get_if<std::int64_t>(&node.value))
        return static_cast<double>(*integer);
    if (const auto* number = std::get_if<double>(&node.value)) return *number;
    return std::nullopt;
}

const Entry* TableNode::find(std::string_view key) const {
    for (const Entry& entry : entries)
        if (entry.key == key) return &entry;
    return nullptr;
}

NodePtr make_node(decltype(Node::value) value, const Place& at) {
    return std::make_shared<const Node>(Node{std::move(value), at});
}

std::optional<Path> split_path(std::string_view text) {
    Path path;
    while (true) {
        if (text.starts_with('"')) {
            const std::size_t close = text.find('"', 1);
            if (close == std::string_view::npos) return std::nullopt;
            path.push_back({std::string(text.substr(1, close - 1)), 0});
            text.remove_prefix(close + 1);
        } else {
            const std::size_t dot = std::min(text.find('.'), text.size());
            if (!append_steps(text.substr(0, dot), path)) return std::nullopt;
            text.remove_prefix(dot);
        }
        if (text.empty()) return path;
        if (text.front() != '.') return std::nullopt;
        text.remove_prefix(1);
    }
}

NodePtr find(const NodePtr& root, const Path& path) {
    NodePtr node = root;
    for (const Step& step : path) {
        if (step.index > 0) {
            const ListNode* list = as_list(node);
            node = list && step.index <= list->size() ? (*list)[step.index - 1] : nullptr;
        } else {
            const TableNode* table = as_table(node);
            const Entry* entry = table ? table->find(step.key) : nullptr;
            node = entry ? entry->value : nullptr;
        }
        if (!node) return nullptr;
    }
    return node;
}

Place place_of(const NodePtr& root, const Path& path) {
    Place place = root->at;
    NodePtr node = root;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const TableNode* table = as_table(node);
        const Entry* entry = table ? table->find(path[i].key) : nullptr;
        node = find(node, {path[i]});
        if (!node) break;
        place = i + 1 == path.size() && entry ? entry->key_at : node->at;
    }
    return place;
}

NodePtr with(const NodePtr& root, const Path& path, const NodePtr& value, const Place& key_at,
             std::string& problem) {
    return with(root, path, 0, value, key_at, problem);
}

NodePtr without(const NodePtr& table, std::string_view key) {
    TableNode changed = std::get<TableNode>(table->value);
    std::erase_if(changed.entries, [&](const Entry& e) { return e.key == key; });
    return make_node(std::move(changed), table->at);
}

NodePtr moved_to(const NodePtr& node, const Place& place) {
    if (const TableNode* table = as_table(node)) {
        TableNode moved = *table;
        for (Entry& entry : moved.entries)
            entry = {entry.key, place, moved_to(entry.value, place)};
        return make_node(std::move(moved), place);
    }
    if (const ListNode* list = as_list(node)) {
        ListNode moved = *list;
        for (NodePtr& item : moved)
            item = moved_to(item, place);
        return make_node(std::move(moved), place);
    }
    return make_node(node->value, place);
}

bool same_value(const Node& a, const Node& b) {
    if (const auto x = as_number(a), y = as_number(b); x && y) return *x == *y;
    return render(a) == render(b);
}

namespace {

/// A basic string of TOML.
std::string toml_string(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            out += std::string{'\\', c};
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            out += c;
    }
    return out + '"';
}

} // namespace

std::string render_key(std::string_view key) {
    const bool is_bare = !key.empty() && std::ranges::all_of(key, [](unsigned char c) {
        return c < 0x80 && (std::isalnum(c) || c == '_' || c == '-');
    });
    return is_bare ? std::string(key) : toml_string(key);
}

std::string render(const Node& node) {
    return std::visit(overloaded{
                          [](const DateNode&) { return std::string("a date"); },
                          [](bool flag) { return std::string(flag ? "true" : "false"); },
                          [](std::int64_t integer) { return fmt::format("{}", integer); },
                          [](double number) { return exact(number); },
                          [](const std::string& text) { return toml_string(text); },
                          [](const ListNode& list) {
                              std::string out = "[";
                              for (std::size_t i = 0; i < list.size(); ++i)
                                  out += (i ? ", " : "") + render(*list[i]);
                              return out + "]";
                          },
                          [](const TableNode& table) {
                              std::string out = "{";
                              for (std::size_t i = 0; i < table.entries.size(); ++i)
                                  out += fmt::format("{}{} = {}", i ? ", " : " ",
                                                     render_key(table.entries[i].key),
                                                     render(*table.entries[i].value));
                              return out + " }";
                          },
                      },
                      node.value);
}

std::string_view kind_name(const Node& node) {
    constexpr std::string_view names[] = {"a date or time", "true or false", "a number", "a number",
                                          "a string",       "a list",        "a table"};
    return names[node.value.index()];
}

} // namespace shearwake::config
