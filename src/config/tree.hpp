#pragma once

#include "config/finding.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace shearwake {

// A TOML document as immutable values that know their place in the file. Trees share what they
// have in common, so that a case of a sweep is the base tree with a few branches replaced.

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

NodePtr make_node(decltype(Node::value) value, const Place& at);

/// The document, or nothing and a finding. Deep nesting is refused rather than followed.
NodePtr parse_toml(std::string_view text, const std::string& file_name, Diagnostics& findings);

/// "medium.layer[2].c_s_m_s": keys, and places in a list counted from 1.
struct Step {
    std::string key;
    std::size_t index = 0; // 0: a key; else the place in a list
};
using Path = std::vector<Step>;

/// Nothing if `text` is no path. A segment in double quotes is one key whatever it holds.
std::optional<Path> split_path(std::string_view text);

/// The node there, or null.
NodePtr find(const NodePtr& root, const Path& path);

/// Where the key is written; else where the innermost table on the way to it is.
Place place_of(const NodePtr& root, const Path& path);

/// `root` with `value` at `path`; tables on the way are made as needed. On the way lies something
/// that is no table, or no such place in a list: null, and `problem` says so.
NodePtr with(const NodePtr& root, const Path& path, const NodePtr& value, const Place& key_at,
             std::string& problem);

/// A table without one of its keys.
NodePtr without(const NodePtr& table, std::string_view key);

/// The same values, all said to stand at `place`.
NodePtr moved_to(const NodePtr& node, const Place& place);

/// Equal values wherever they stand; 2 and 2.0 are equal.
bool same_value(const Node& a, const Node& b);

/// As TOML on one line: strings in quotes.
std::string render(const Node& node);

/// "a number", "a list", ... for messages.
std::string_view kind_name(const Node& node);

} // namespace shearwake
