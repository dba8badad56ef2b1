// SPDX-License-Identifier: BSD-3-Clause
#include "config/table_options.hpp"

#include "base/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <unordered_set>

namespace shearwake::config {
namespace {

/// The keys of a sweep with errors are unknown, so nothing further is reported.
bool is_swept(const Reader& reader, std::string_view key, const std::string& word,
              const std::vector<std::string>& swept, const Sweep& sweep) {
    if (!sweep.sound || std::find(swept.begin(), swept.end(), word) != swept.end()) return true;
    const auto meant = word.size() < 100 ? nearest(word, swept) : std::nullopt;
    reader.error(key, fmt::format("contains \"{}\", which is not swept{}", excerpt(word),
                                  meant ? fmt::format("; did you mean \"{}\"?", *meant) : ""));
    return false;
}

/// The other keys on the axis of x are determined by x, unless x contains a value twice.
bool x_tells_all(const SweptKey& x) {
    std::unordered_set<std::string> values;
    for (const NodePtr& value : x.values)
        values.insert(render(*value));
    return values.size() == x.values.size();
}

std::vector<std::string> default_series(const Sweep& sweep, const std::string& x) {
    std::vector<std::string> series;
    for (const Axis& axis : sweep.axes) {
        const auto its_x = std::find_if(axis.keys.begin(), axis.keys.end(),
                                        [&](const SweptKey& key) { return key.key == x; });
        if (its_x != axis.keys.end() && x_tells_all(*its_x)) continue;
        for (const SweptKey& key : axis.keys)
            if (key.key != x) series.push_back(key.key);
    }
    return series;
}

/// The page of the report reads the labels from the job file; here they are checked only.
void check_labels(Reader labels, const std::vector<std::string>& swept, const Sweep& sweep) {
    for (const std::string& key : labels.keys()) {
        const auto texts = labels.find_words(key);
        if (!is_swept(labels, key, key, swept, sweep) || !texts || !sweep.sound) continue;
        for (const Axis& axis : sweep.axes)
            for (const SweptKey& of : axis.keys) {
                if (of.key != key) continue;
                std::unordered_set<std::string> values;
                for (const NodePtr& value : of.values)
                    values.insert(render(*value));
                if (values.size() != texts->size())
                    labels.error(key, fmt::format("has {} labels, but the key has {} values",
                                                  texts->size(), values.size()));
            }
    }
    labels.finish();
}

} // namespace

TableSection read_table(Reader reader, const Sweep& sweep) {
    const std::vector<std::string> swept = sweep.keys();
    TableSection table;
    const auto x = reader.find_word("x");
    const bool x_is_swept = x && is_swept(reader, "x", *x, swept, sweep);
    table.options.x = x_is_swept ? *x : swept.empty() ? "" : swept.front();
    if (const auto series = reader.find_words("series")) {
        for (const std::string& key : *series) {
            if (is_swept(reader, "series", key, swept, sweep) && key == table.options.x)
                reader.error("series", fmt::format("contains \"{}\", which is already x", key));
            if (std::count(series->begin(), series->end(), key) > 1)
                reader.error("series", fmt::format("contains \"{}\" twice", excerpt(key)));
        }
        table.options.series = *series;
    } else {
        table.options.series = default_series(sweep, table.options.x);
    }
    check_labels(reader.optional_table("labels"), swept, sweep);
    const NodePtr reference = reader.node("reference");
    if (!reader.optional_table("reference").empty()) table.reference = reference;
    if (table.reference && std::get<TableNode>(reference->value).entries.empty())
        reader.error("reference", "must change at least one key, for example { kind = \"STM\" }");
    reader.finish();
    return table;
}

} // namespace shearwake::config
