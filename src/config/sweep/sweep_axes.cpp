// SPDX-License-Identifier: BSD-3-Clause
#include "config/sweep/sweep.hpp"

#include "base/text.hpp"
#include "config/keys/key_table.hpp"
#include "config/sections/read_case.hpp"
#include "sampling/next_points.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <tuple>
#include <unordered_set>

namespace shearwake::config {
namespace {

using Flat = std::vector<Entry>;

/// Descends into tables to the values according to `is_leaf`; joins the keys with dots.
void flatten(const TableNode& table, const std::string& prefix,
             const std::function<bool(const std::string&, const Node&)>& is_leaf, Flat& out) {
    for (const Entry& entry : table.entries) {
        const std::string key = prefix.empty() ? entry.key : prefix + "." + entry.key;
        const auto* below = std::get_if<TableNode>(&entry.value->value);
        if (below && !is_leaf(key, *entry.value))
            flatten(*below, key, is_leaf, out);
        else
            out.push_back({key, entry.key_at, entry.value});
    }
}

bool is_axis(const std::string&, const Node& node) {
    return is_generator(node) || is_adaptive(node) ||
           std::get<TableNode>(node.value).entries.empty();
}

Flat flat_axes(const TableNode& table) {
    Flat flat;
    flatten(table, "", is_axis, flat);
    return flat;
}

/// Reads [sweep] and records the keys that it contains.
class SweepReader {
public:
    SweepReader(const AxisPoints& points, DiagnosticList& diagnostics)
        : points_(points), diagnostics_(diagnostics) {}

    void read_axis(const Entry& entry) {
        if (auto key = read_key(entry)) sweep_.axes.push_back({{std::move(*key)}});
    }

    void read_zip(const NodePtr& zip) {
        const auto* list = std::get_if<ListNode>(&zip->value);
        if (!list) {
            diagnostics_.error(
                zip->at, "sweep.zip must be a list of tables, each with keys that change together");
            return;
        }
        for (const NodePtr& item : *list)
            read_zipped(item);
    }

    void read_exclusions(const NodePtr& exclude) {
        const auto* list = std::get_if<ListNode>(&exclude->value);
        if (!list) {
            diagnostics_.error(exclude->at, "sweep.exclude must be a list of tables, each with a "
                                            "combination of values to exclude");
            return;
        }
        for (const NodePtr& item : *list)
            read_exclusion(item);
    }

    Sweep take() { return std::move(sweep_); }

private:
    std::optional<SweptKey> read_key(const Entry& entry) {
        const auto path = case_path(entry, "sweep", diagnostics_);
        if (!path) return std::nullopt;
        if (!keys_.insert(entry.key).second) {
            diagnostics_.error(entry.key_at, fmt::format("sweep: {} is swept twice", entry.key));
            return std::nullopt;
        }
        auto values = is_adaptive(*entry.value) ? adaptive_values(entry)
                                                : axis_values(entry.key, entry.value, diagnostics_);
        if (values.empty()) return std::nullopt; // already reported
        return SweptKey{entry.key, *path, entry.key_at, std::move(values)};
    }

    /// The points of the axis; none after an error.
    std::vector<NodePtr> adaptive_values(const Entry& entry) {
        auto axis = read_adaptive_axis(entry.key, entry.value, diagnostics_);
        if (!axis) return {};
        const auto known = points_.find(entry.key);
        std::vector<NodePtr> values;
        for (const double x : known == points_.end() ? adapt::first_points(*axis) : known->second)
            values.push_back(make_node(x, entry.value->at));
        sweep_.adaptive.push_back(std::move(*axis));
        return values;
    }

    void read_zipped(const NodePtr& item) {
        const auto* table = std::get_if<TableNode>(&item->value);
        if (!table || table->entries.empty()) {
            diagnostics_.error(item->at, "sweep.zip: each entry must be a table of swept keys");
            return;
        }
        Axis axis;
        const Flat flat = flat_axes(*table);
        for (const Entry& entry : flat)
            if (is_adaptive(*entry.value))
                diagnostics_.error(entry.value->at,
                                   fmt::format("sweep.zip: {} is adaptive; its points follow from "
                                               "results, so other keys cannot change together with "
                                               "it",
                                               entry.key));
            else if (auto key = read_key(entry))
                axis.keys.push_back(std::move(*key));
        if (axis.keys.size() != flat.size()) return;
        for (const SweptKey& key : axis.keys) {
            if (key.values.size() == axis.size()) continue;
            diagnostics_.error(key.at,
                               fmt::format("sweep.zip: {} has {} values and {} has {}; keys that "
                                           "change together must have the same number of values",
                                           axis.keys.front().key, axis.size(), key.key,
                                           key.values.size()));
            return;
        }
        sweep_.axes.push_back(std::move(axis));
    }

    void read_exclusion(const NodePtr& item) {
        const auto* table = std::get_if<TableNode>(&item->value);
        if (!table || table->entries.empty()) {
            diagnostics_.error(item->at, "sweep.exclude: each entry must be a table of values of "
                                         "swept keys");
            return;
        }
        Flat flat;
        flatten(
            *table, "", [&](const std::string& key, const Node&) { return keys_.contains(key); },
            flat);
        Exclusion exclusion{item->at, {}};
        for (const Entry& entry : flat) {
            if (!keys_.contains(entry.key)) {
                const auto meant =
                    entry.key.size() < 100
                        ? nearest(entry.key, std::vector<std::string>(keys_.begin(), keys_.end()))
                        : std::nullopt;
                diagnostics_.error(
                    entry.key_at,
                    fmt::format("sweep.exclude: {} is not swept{}", excerpt(entry.key),
                                meant ? fmt::format("; did you mean {}?", *meant) : ""));
            }
            exclusion.values.emplace_back(entry.key, entry.value);
        }
        sweep_.exclusions.push_back(std::move(exclusion));
    }

    const AxisPoints& points_;
    DiagnosticList& diagnostics_;
    Sweep sweep_;
    std::set<std::string> keys_;
};

/// If an axis contained a combination of values twice, all cases would be duplicated.
void check_repeats(const Axis& axis, DiagnosticList& diagnostics) {
    std::unordered_set<std::string> seen;
    for (std::size_t i = 0; i < axis.size(); ++i) {
        std::string together;
        for (const SweptKey& key : axis.keys)
            together += render(*key.values[i]) + "\n";
        if (seen.insert(together).second) continue;
        together.pop_back();
        std::replace(together.begin(), together.end(), '\n', ',');
        diagnostics.error(axis.keys.front().values[i]->at,
                          fmt::format("sweep: {} contains the value {} twice",
                                      axis.keys.front().key, excerpt(together)));
    }
}

/// Limits of a sweep; larger ones are considered a typing error and rejected before they cost time.
constexpr std::size_t most_keys = 50;
constexpr std::size_t most_exclusions = 1000;

void check_size(Sweep& sweep, DiagnosticList& diagnostics) {
    double cases = 1.0;
    std::size_t keys = 0;
    for (const Axis& axis : sweep.axes) {
        cases *= static_cast<double>(axis.size());
        keys += axis.keys.size();
    }
    if (cases > static_cast<double>(most_cases))
        diagnostics.error(sweep.at,
                          fmt::format("sweep results in {:.0f} cases; at most {} are supported: "
                                      "divide it into several jobs",
                                      cases, most_cases));
    if (sweep.exclusions.size() > most_exclusions)
        diagnostics.error(sweep.at,
                          fmt::format("sweep.exclude has {} entries; at most {} are supported",
                                      sweep.exclusions.size(), most_exclusions));
    if (keys > most_keys) {
        diagnostics.error(
            sweep.at, fmt::format("sweep has {} keys; at most {} are supported", keys, most_keys));
        sweep.axes.clear();
    }
}

} // namespace

std::vector<std::string> Sweep::keys() const {
    std::vector<std::string> names;
    for (const Axis& axis : axes)
        for (const SweptKey& key : axis.keys)
            names.push_back(key.key);
    return names;
}

bool Sweep::contains(std::string_view key) const {
    for (const Axis& axis : axes)
        for (const SweptKey& swept : axis.keys)
            if (swept.key == key) return true;
    return false;
}

std::optional<Path> case_path(const Entry& entry, std::string_view where,
                              DiagnosticList& diagnostics) {
    auto path = split_path(entry.key);
    const auto tables = case_tables();
    if (path && path->size() > 1 && std::ranges::find(tables, path->front().key) != tables.end())
        return path;
    const std::vector<std::string> names(tables.begin(), tables.end());
    const std::string meant = full_key_hint(entry.key);
    diagnostics.error(
        entry.key_at,
        fmt::format("{}: \"{}\" is not a key of a case; {}", where, excerpt(entry.key),
                    meant.empty() ? "the key is given in full and starts with " + quoted_list(names)
                                  : meant));
    return std::nullopt;
}

NodePtr flattened_sweep(const NodePtr& sweep) {
    return flattened(sweep, is_axis);
}

NodePtr flattened(const NodePtr& node,
                  const std::function<bool(const std::string& key, const Node&)>& is_leaf) {
    const auto* table = node ? std::get_if<TableNode>(&node->value) : nullptr;
    if (!table) return node;
    Flat flat;
    flatten(*table, "", is_leaf, flat);
    std::stable_sort(flat.begin(), flat.end(), [](const Entry& a, const Entry& b) {
        return std::tie(a.key_at.line, a.key_at.column) < std::tie(b.key_at.line, b.key_at.column);
    });
    return make_node(TableNode{std::move(flat)}, node->at);
}

void check_sweep(Sweep& sweep, DiagnosticList& diagnostics) {
    for (const Axis& axis : sweep.axes)
        check_repeats(axis, diagnostics);
    check_size(sweep, diagnostics);
}

Sweep read_sweep(const NodePtr& sweep, const AxisPoints& points, DiagnosticList& diagnostics) {
    if (!sweep) return {};
    const std::size_t before = diagnostics.errors();
    const auto* table = std::get_if<TableNode>(&sweep->value);
    if (!table) {
        diagnostics.error(sweep->at, "sweep must be a table");
        return {.at = sweep->at, .sound = false};
    }
    SweepReader reader(points, diagnostics);
    for (const Entry& entry : table->entries) {
        if (entry.key == "zip") reader.read_zip(entry.value);
        if (entry.key != "zip" && entry.key != "exclude" && entry.key != "list")
            reader.read_axis(entry);
    }
    if (const Entry* exclude = table->find("exclude")) reader.read_exclusions(exclude->value);
    Sweep read = reader.take();
    read.at = sweep->at;
    check_sweep(read, diagnostics);
    read.sound = diagnostics.errors() == before;
    return read;
}

} // namespace shearwake::config
