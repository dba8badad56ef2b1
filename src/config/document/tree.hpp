// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/diagnostic.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace shearwake::config {

// A TOML document as immutable values with their locations in the file. Trees share common parts,
// so that a case of a sweep is the base tree with a few branches replaced.

struct Node;
using NodePtr = std::shared_ptr<const Node>;

struct Entry {
    std::string key;
    Place key_at;
    NodePtr value;
};

/// In the order of the file.
struct TableNode {
    std::vector<Entry> entries;
    const Entry* find(std::string_view key) const;
};

using ListNode = std::vector<NodePtr>;
struct DateNode {};

struct Node {
    std::variant<DateNode, bool, std::int64_t, double, std::string, ListNode, TableNode> value;
    Place at;
};

/// The value of a number of either type.
std::optional<double> as_number(const Node& node);

NodePtr make_node(decltype(Node::value) value, const Place& at);

/// Parses a document; null and a diagnostic after an error. Deep nesting is rejected.
NodePtr parse_toml(std::string_view text, const std::string& file_name,
                   DiagnosticList& diagnostics);

/// A path such as "medium.layer[2].c_s_m_s" consists of keys and of list indices counted from 1.
struct Step {
    std::string key;
    std::size_t index = 0; // 0: a key; otherwise an index in a list
};
using Path = std::vector<Step>;

/// Splits a path; nothing if it is not valid. A segment in double quotes is a single key.
std::optional<Path> split_path(std::string_view text);

/// The node at `path`, or null.
NodePtr find(const NodePtr& root, const Path& path);

/// The location of the key; if it is absent, that of the innermost existing table on the path.
Place place_of(const NodePtr& root, const Path& path);

/// `root` with `value` at `path`; missing tables are created. If an intermediate node is not a
/// table, or a list has no such index, returns null and sets `problem`.
NodePtr with(const NodePtr& root, const Path& path, const NodePtr& value, const Place& key_at,
             std::string& problem);

/// A table without the given key.
NodePtr without(const NodePtr& table, std::string_view key);

/// The same values with `place` as their location.
NodePtr moved_to(const NodePtr& node, const Place& place);

/// Compares values and ignores locations; 2 and 2.0 are equal.
bool same_value(const Node& a, const Node& b);

/// The node as TOML on one line.
std::string render(const Node& node);
/// A key as in TOML: bare or quoted.
std::string render_key(std::string_view key);

/// "a number", "a list", ... for messages.
std::string_view kind_name(const Node& node);

} // namespace shearwake::config
