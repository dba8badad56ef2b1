// SPDX-License-Identifier: BSD-3-Clause
#include "config/sweep/override.hpp"

#include "base/text.hpp"
#include "config/keys/key_table.hpp"
#include "config/sections/read_case.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace shearwake::config {

namespace {

bool is_bare_word(std::string_view text) {
    const auto is_letter = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.' ||
               c == ' ' || c == '/';
    };
    return !text.empty() && std::isalpha(static_cast<unsigned char>(text.front())) &&
           std::all_of(text.begin(), text.end(), is_letter);
}

/// Whether the value is a list of numbers without brackets: "60,60" for a key with a list, or more
/// than two numbers.
bool is_bare_list(const std::string& value, const NodePtr& before) {
    const auto commas = std::ranges::count(value, ',');
    const bool has_list = before && std::holds_alternative<ListNode>(before->value);
    DiagnosticList trial;
    return (commas > 1 || (commas == 1 && has_list)) &&
           parse_toml("value = [" + value + "]", "", trial) && trial.errors() == 0;
}

/// `before`: the value that the override replaces, or null.
NodePtr parse_value(const std::string& value, const NodePtr& before, const Place& at,
                    DiagnosticList& diagnostics) {
    DiagnosticList trial;
    const NodePtr document = parse_toml("value = " + value, *at.file, trial);
    const auto* table = document ? std::get_if<TableNode>(&document->value) : nullptr;
    if (table && table->entries.size() == 1 && trial.errors() == 0)
        return moved_to(table->entries.front().value, at);
    if (is_bare_word(value)) return make_node(value, at);
    if (is_bare_list(value, before)) {
        diagnostics.error(
            at, fmt::format("write lists in brackets: [{0}] instead of {0}", excerpt(value)));
        return nullptr;
    }
    if (const auto number = with_decimal_point(value)) {
        diagnostics.error(at, fmt::format("write decimal numbers with a point: {} instead of {}{}",
                                          excerpt(*number), excerpt(value),
                                          before ? "" : "; lists are written in brackets"));
        return nullptr;
    }
    diagnostics.error(
        at, fmt::format("\"{}\" is not a valid TOML value, such as 0.5, [1, 2] or \"word\"",
                        excerpt(value)));
    return nullptr;
}

/// A swept key is a single key of [sweep], whether or not its dots were quoted. A key below one
/// that `root` has, such as the tolerance of an adaptive axis, is not joined with it.
Path joined_below_sweep(const NodePtr& root, const Path& path, std::string_view text) {
    if (path.size() <= 2 || (path.front().key != "sweep" && path.front().key != "uncertain") ||
        find(root, {path[0], path[1]}))
        return path;
    return {path.front(), {std::string(text.substr(text.find('.') + 1))}};
}

/// The first value of a list.
NodePtr first_of(const NodePtr& list) {
    const auto* values = list ? std::get_if<ListNode>(&list->value) : nullptr;
    return values && !values->empty() ? values->front() : nullptr;
}

/// The values that [sweep] states for a key, in a list of its own or in `zip`; null without any.
NodePtr swept_values(const NodePtr& root, const std::string& key) {
    const NodePtr own = find(root, {{"sweep"}, {key}}), zip = find(root, {{"sweep"}, {"zip"}});
    const auto* zipped = zip ? std::get_if<ListNode>(&zip->value) : nullptr;
    for (std::size_t i = 0; !own && zipped && i < zipped->size(); ++i)
        if (const NodePtr values = find(flattened_sweep((*zipped)[i]), {{key}})) return values;
    return own;
}

/// Rejects a value of another type than those of the sweep of its key. Returns whether it fits.
bool check_type(const NodePtr& root, const Override& override, const Node& value, const Place& at,
                DiagnosticList& diagnostics) {
    const NodePtr swept = first_of(swept_values(root, override.key));
    if (!swept || !as_number(*swept) || as_number(value)) return true;
    diagnostics.error(at,
                      fmt::format("{} must be a number, like the values of its sweep, but is {}",
                                  override.key, excerpt(render(value))));
    return false;
}

/// How to change the values of a key that varies.
std::string advice(const NodePtr& root, const std::string& key, const NodePtr& value) {
    if (find(root, {{"sweep"}, {key}}) && value)
        return fmt::format("to compute only this value, use -S 'sweep.\"{}\"=[{}]'", key,
                           excerpt(render(*value)));
    if (find(root, {{"uncertain"}, {key}})) return "change its distribution in [uncertain]";
    if (find(root, {{"sweep"}, {key}})) return "change its values in [sweep]";
    return swept_values(root, key) ? "change its values in sweep.zip of the job file"
                                   : "change its values in the file of the sweep";
}

/// Whether the key begins with the name of a table or key of a job.
bool is_full(const Path& path) {
    const auto tables = case_tables();
    const std::string& first = path.front().key;
    return first == "schema" || first == "job" || first == "sweep" || first == "uncertain" ||
           first == "table" || first == "optimise" ||
           std::ranges::find(tables, first) != tables.end();
}

} // namespace

Place place_of(const Override& override) {
    return {std::make_shared<const std::string>("-S " + excerpt(override.key)), 0, 0};
}

NodePtr with_override(const NodePtr& root, const Override& override, DiagnosticList& diagnostics) {
    const Place at = place_of(override);
    const auto path = split_path(override.key);
    if (!path) {
        diagnostics.error(at,
                          "this is not a valid key; give it in full, as in -S load.peak_Pa=200");
        return root;
    }
    if (const std::string meant = is_full(*path) ? "" : full_key_hint(override.key);
        !meant.empty()) {
        diagnostics.error(at, fmt::format("{} is unknown; {}", excerpt(override.key), meant));
        return root;
    }
    const NodePtr value = parse_value(override.value, find(root, *path), at, diagnostics);
    if (!value) return root;
    if (!check_type(root, override, *value, at, diagnostics)) return root;
    std::string problem;
    const NodePtr changed =
        with(root, joined_below_sweep(root, *path, override.key), value, at, problem);
    if (!changed) diagnostics.error(at, problem);
    return changed ? changed : root;
}

void check_overrides(const NodePtr& root, std::span<const Override> overrides,
                     std::span<const std::string> varied, DiagnosticList& diagnostics) {
    for (const Override& override : overrides)
        for (const std::string& key : varied) {
            const Place at = place_of(override);
            const auto path = split_path(key);
            const NodePtr value = path ? find(root, *path) : nullptr;
            const bool is_set = value && value->at.file && *value->at.file == *at.file;
            const bool is_part =
                override.key.starts_with(key + ".") || override.key.starts_with(key + "[");
            if (!is_set && !is_part) continue;
            diagnostics.warning(
                at, fmt::format("{} is {}, so this override has no effect{}; {}", key,
                                find(root, {{"uncertain"}, {key}}) ? "uncertain" : "swept",
                                is_part || override.key == key ? "" : " on it",
                                advice(root, key, is_part ? nullptr : value)));
        }
}

namespace {

constexpr std::string_view mark = "-S ";
constexpr std::size_t longest_inline = 100;

/// Whether an override has set this value.
bool is_set(const Node& node) {
    return node.at.file && node.at.file->starts_with(mark);
}

/// Whether an override has set a value in this node.
bool has_set(const Node& node) {
    if (is_set(node)) return true;
    if (const auto* list = std::get_if<ListNode>(&node.value))
        return std::ranges::any_of(*list, [](const NodePtr& item) { return has_set(*item); });
    const auto* table = std::get_if<TableNode>(&node.value);
    return table && std::ranges::any_of(table->entries,
                                        [](const Entry& entry) { return has_set(*entry.value); });
}

bool is_list_of_tables(const Node& node) {
    const auto* list = std::get_if<ListNode>(&node.value);
    return list && !list->empty() && std::ranges::all_of(*list, [](const NodePtr& item) {
               return std::holds_alternative<TableNode>(item->value);
           });
}

/// Writes a tree as a document with headers of tables.
class Writer {
public:
    explicit Writer(const NodePtr& before) : before_(before) {}

    /// The values of a table, then the tables in it. `header`: its name in TOML.
    void write(const TableNode& table, const Path& path, const std::string& header) {
        std::vector<const Entry*> tables;
        for (const Entry& entry : table.entries)
            if (is_written_as_table(entry, path.empty()))
                tables.push_back(&entry);
            else
                write_value(entry, with_step(path, {entry.key}));
        for (const Entry* entry : tables) {
            const std::string name = header + (header.empty() ? "" : ".") + render_key(entry->key);
            const Path inner = with_step(path, {entry->key});
            if (const auto* one = std::get_if<TableNode>(&entry->value->value)) {
                text += fmt::format("\n[{}]\n", name);
                write(*one, inner, name);
                continue;
            }
            const auto& list = std::get<ListNode>(entry->value->value);
            for (std::size_t i = 0; i < list.size(); ++i) {
                text += fmt::format("\n[[{}]]\n", name);
                write(std::get<TableNode>(list[i]->value), with_step(inner, {"", i + 1}), name);
            }
        }
    }

    std::string text;

private:
    static Path with_step(Path path, Step step) {
        path.push_back(std::move(step));
        return path;
    }

    /// Short tables are written on one line, and so are those that an override has set as a whole.
    static bool is_written_as_table(const Entry& entry, bool at_top) {
        const Node& node = *entry.value;
        if (is_set(node)) return false;
        if (std::holds_alternative<TableNode>(node.value))
            return at_top || has_set(node) || render(node).size() > longest_inline;
        return is_list_of_tables(node) && (has_set(node) || render(node).size() > longest_inline);
    }

    void write_value(const Entry& entry, const Path& path) {
        text += fmt::format("{} = {}", render_key(entry.key), render(*entry.value));
        if (has_set(*entry.value)) {
            const NodePtr old = find(before_, path);
            text += old ? fmt::format(" # -S; in the file: {}", excerpt(render(*old)))
                        : " # -S; not in the file";
        }
        text += '\n';
    }

    const NodePtr& before_;
};

} // namespace

std::string text_with_overrides(const NodePtr& before, const NodePtr& after,
                                const std::string& file_name, std::string_view file_text) {
    Writer writer(before);
    while (file_text.starts_with('#')) {
        const std::size_t end = std::min(file_text.find('\n'), file_text.size() - 1) + 1;
        writer.text += file_text.substr(0, end);
        file_text.remove_prefix(end);
    }
    writer.text += fmt::format("{}# {} with the values of the command line (-S), which are marked. "
                               "Other comments of the file are left out.\n",
                               writer.text.empty() ? "" : "\n",
                               excerpt(std::filesystem::path(file_name).filename().string()));
    writer.write(std::get<TableNode>(after->value), {}, "");
    return writer.text;
}

} // namespace shearwake::config
