// SPDX-License-Identifier: BSD-3-Clause
#include "config/keys/key_table.hpp"

#include "base/text.hpp"
#include "base/units.hpp"
#include "config/document/job_keys.hpp"
#include "config/document/key_range.hpp"
#include "config/document/presets.hpp"
#include "config/keys/schema_types.hpp"
#include "config/sections/read_case.hpp"
#include "problem/case/case_fields.hpp"
#include "problem/case/optimise_options.hpp"

#include <array>
#include <deque>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace shearwake::config {
namespace {

/// One table of the key reference.
struct Section {
    std::string name; // name of the table in the job, such as "solver.pstd"
    std::string heading;
    std::string prefix; // prefix of its keys, such as "footprint."
    std::string rows;
};

/// A walk that lists keys. Alternatives and list elements get their own sections, which follow the
/// section that selects them.
class KeyTable {
public:
    template <class T>
    void operator()(const T& value, const Field& field) {
        if (*field.key) row(field, allowed(value, field), fallback(value, field));
    }

    template <class T>
    void key(const T& example, const Field& field) {
        (*this)(example, field);
    }

    void key(const Field& field) {
        (*this)(nullptr, field);
        with_inline_table(field, [&](const auto& keys) {
            const std::string name = fmt::format("{}.{}", sections_[at_].name, field.key);
            open({.name = name, .heading = fmt::format("`[{}]`", name)});
            walk_fields(*this, keys);
            close();
        });
    }

    template <class... T>
    void choice(const std::variant<T...>& value, const Field& field) {
        const std::string key = field.key;
        if (!key.empty()) {
            const std::array names = {name_in_jobs<T>()...};
            row(field, *field.type ? words_or_range(field) : list_of(names),
                *field.fallback ? field.fallback : text(Json(names[value.index()])));
        }
        for_each_alternative(
            std::type_identity<std::variant<T...>>{}, [&](const auto& alternative) {
                using Alternative = std::decay_t<decltype(alternative)>;
                if (key.empty()) return walk_fields(*this, alternative);
                const Section before = sections_[at_];
                const std::string name = name_in_jobs<Alternative>();
                if (field.own_tables)
                    open({.name = before.name + "." + name,
                          .heading = fmt::format("`[{}.{}]`", before.name, name)});
                else
                    open({.name = before.name,
                          .heading = fmt::format("{} {} `{}{} = \"{}\"`", before.heading,
                                                 before.heading.ends_with("]`") ? "with" : "and",
                                                 before.prefix, key, name),
                          .prefix = before.prefix + key.substr(0, key.rfind('.') + 1)});
                walk_fields(*this, alternative);
                close();
            });
        if (key == "path.shape") list_shapes(sections_[at_].heading);
    }

    template <class T>
    void each(const char* table, const std::vector<T>&, const Field& field) {
        open({.name = table, .heading = fmt::format("`[[{}]]`", table)});
        const T example = Example<T>::make();
        if constexpr (requires { example.valueless_by_exception(); })
            choice(example, field);
        else
            walk_fields(*this, example);
        close();
    }

    template <class T>
    void maybe(const char* table, const std::optional<T>&) {
        section(table);
        const T example = Example<T>::make();
        walk_fields(*this, example);
    }

    void section(const char* table) {
        sections_.push_back({.name = table, .heading = fmt::format("`[{}]`", table)});
        at_ = sections_.size() - 1;
    }

    std::string markdown() const {
        std::string text;
        for (const Section& section : sections_)
            if (!section.rows.empty())
                text += fmt::format("\n## {}\n\n| key | values | default | meaning |\n"
                                    "|---|---|---|---|\n{}",
                                    section.heading, section.rows);
        return text;
    }

private:
    /// The shapes that exist only in job files.
    void list_shapes(const std::string& heading) {
        for_each_alternative(std::type_identity<PathShapes>{}, [&](const auto& shape) {
            open({.heading = fmt::format("{} and `path.shape = \"{}\"`", heading, shape.name),
                  .prefix = "path."});
            walk_fields(*this, shape);
            close();
        });
    }
    void open(Section section) {
        opened_.push_back(at_);
        sections_.push_back(std::move(section));
        at_ = sections_.size() - 1;
    }
    void close() {
        at_ = opened_.back();
        opened_.pop_back();
    }
    void row(const Field& field, const std::string& values, const std::string& fallback) {
        const std::string only =
            *field.only_with ? fmt::format("with `{}`: ", field.only_with) : "";
        std::string meaning;
        for (const char c : only + field.meaning)
            meaning += c == '|' ? std::string("\\|") : std::string(1, c);
        sections_[at_].rows += fmt::format("| `{}{}` | {} | {} | {} |\n", sections_[at_].prefix,
                                           field.key, values, fallback, meaning);
    }

    template <class T>
    static std::string allowed(const T& value, const Field& field) {
        if (!words_of(field).empty()) return words_or_range(field);
        const Json type = *field.type ? named_type(field) : type_of(value, field);
        const Json& one = type.contains("items") ? type.at("items") : type;
        if (one.contains("enum")) return list_of(one.at("enum").get<std::vector<std::string>>());
        if (one.value("type", std::string()) != "boolean") return words_or_range(field);
        return *field.text && !*field.type ? "" : "true or false";
    }
    static std::string words_or_range(const Field& field) {
        const std::string_view type = field.type;
        if (type == "name") return fmt::format("1 to {} characters", longest_file_name);
        if (type == "ends and count") return "a count " + field.range.words();
        std::string range = key_range(field.key, field.range).words();
        if (range == Range{}.words()) range.clear();
        if (field.least_count > 0) {
            const std::string most =
                field.most_count > 0 ? fmt::format("to {}", field.most_count) : "or more";
            range = fmt::format("{} {} values{}{}", field.least_count, most,
                                range.empty() ? "" : ", each ", range);
        }
        const auto words = words_of(field);
        if (words.empty()) return range;
        if (!type.starts_with("point")) return list_of(words);
        return fmt::format("{}, or `[x, y]` {}", list_of(words), range);
    }
    static std::string list_of(const auto& names) {
        std::string list;
        for (const auto& name : names)
            list += fmt::format("{}`\"{}\"`", list.empty() ? "" : ", ", name);
        return list;
    }

    template <class T>
    static std::string fallback(const T& value, const Field& field) {
        if (*field.fallback) return field.fallback;
        if (field.given == Given::required) return "required";
        if (field.given == Given::preset) return "required without a preset";
        return text(value, field.key);
    }
    /// The value as a job file would contain it, in the unit of its key.
    static std::string text(const Json& value) {
        if (value.is_string()) return fmt::format("`\"{}\"`", value.get<std::string>());
        if (value.is_float()) return fmt::format("{:.6g}", value.get<double>());
        if (!value.is_array()) return value.is_null() ? "" : value.dump();
        std::string list;
        for (const Json& item : value)
            list += (list.empty() ? "" : ", ") + text(item);
        return "[" + list + "]";
    }
    template <class T>
    static std::string text(const T& value, const char* key) {
        return text(shown(value, key));
    }
    template <class T>
    static std::string text(const std::optional<T>& value, const char* key) {
        return value ? text(*value, key) : "none";
    }
    template <class T>
    static std::string text(const std::vector<T>& values, const char* key) {
        if constexpr (Named<T>) return values.empty() ? "none" : "all";
        Json list = Json::array();
        for (const T& value : values)
            list.push_back(shown(value, key));
        return text(list);
    }

    std::deque<Section> sections_;
    std::size_t at_ = 0;
    std::vector<std::size_t> opened_;
};

} // namespace

std::string preset_reference() {
    return layer_and_body_presets() + array_presets();
}

std::string key_reference() {
    constexpr const char* preface =
        "# The keys of a job\n\n"
        "`shearwake keys` prints this reference. Values and defaults are in the unit of the key;\n"
        "[job-file.md](job-file.md) has examples and explanations. Besides these options, "
        "`[sweep]` and\n"
        "`[uncertain]` contain keys in full, which `KEY` stands for.\n";
    KeyTable table;
    const auto add = [&]<class Keys>(const char* name, Keys keys) {
        table.section(name);
        walk_fields(table, keys);
    };
    add("job", JobTableKeys{});
    table.section("medium");
    const Case defaults;
    walk_fields(table, defaults);
    const OptimiseOptions optimise;
    walk_fields(table, optimise);
    add("sweep", SweepTableKeys{});
    add("sweep.KEY", AxisKeys{});
    add("uncertain", UncertainTableKeys{});
    add("uncertain.KEY", DistributionKeys{});
    add("table", TableKeys{});
    return preface + table.markdown();
}

namespace {

constexpr std::size_t most_suggestions = 3;
constexpr std::size_t longest_ending = 60;

/// Adds the keys that a table of the schema describes.
void add_keys(const Json& table, const std::string& prefix, std::vector<std::string>& keys) {
    const Json* properties = table.find("properties");
    if (!properties) return;
    for (const auto& [name, content] : properties->items()) {
        keys.push_back(prefix + name);
        add_keys(content, prefix + name + ".", keys);
        if (const Json* items = content.find("items"))
            add_keys(*items, prefix + name + "[1].", keys);
    }
}

/// What follows the last dot.
std::string last_word(const std::string& key) {
    return key.substr(key.rfind('.') + 1);
}

std::vector<std::string> keys_that_end_in(const std::string& ending,
                                          const std::vector<std::string>& keys) {
    std::vector<std::string> found;
    for (const std::string& key : keys)
        if (key.ends_with("." + ending)) found.push_back(key);
    return found;
}

/// The keys of a job in full, such as "load.peak_Pa" and "medium.layer[1].c_s_m_s".
std::vector<std::string> key_names() {
    std::vector<std::string> keys;
    add_keys(schema_of_jobs(), "", keys);
    return keys;
}

} // namespace

std::string full_key_hint(std::string_view ending) {
    if (ending.size() > longest_ending) return "";
    const std::vector<std::string> keys = key_names();
    std::vector<std::string> meant = keys_that_end_in(std::string(ending), keys);
    if (meant.empty() && ending.find('.') == std::string_view::npos) {
        std::vector<std::string> words;
        for (const std::string& key : keys)
            words.push_back(key.find('.') == std::string::npos ? key : last_word(key));
        const auto word = nearest(ending, words);
        if (!word || std::ranges::find(keys, *word) != keys.end()) return ""; // a table
        meant = keys_that_end_in(*word, keys);
    }
    if (meant.empty() || meant.size() > most_suggestions) return "";
    return fmt::format("did you mean {}?", fmt::join(meant, " or "));
}

} // namespace shearwake::config
