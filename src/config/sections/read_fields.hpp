// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"
#include "config/document/reader.hpp"
#include "problem/case/case_fields.hpp"

#include <array>
#include <string>

namespace shearwake::config {

/// A length or time in mm or ms, as the user wrote it: 0.3 and not 0.30000000000000004.
std::string in_milli(double x_SI);

/// Reads [x, y, z]; a valid substitute after an error.
Vec3 read_triple(Reader& reader, std::string_view key, const Range& range);

/// An optional key with the default that its description states: its fallback in the unit of the
/// key, or the first of its words.
double read_optional_number(Reader& reader, const Field& field);
std::string read_optional_word(Reader& reader, const Field& field);

/// A whole number, or nothing; after an error, the next smaller one.
std::optional<double> find_integer(Reader& reader, std::string_view key, const Range& range);

/// Two whole numbers; after an error, nothing. `meaning`: how the message continues.
std::optional<std::array<int, 2>> find_integer_pair(Reader& reader, std::string_view key,
                                                    const Range& range, std::string_view meaning);

/// A walk that reads the keys of one table into the fields of a struct, which initially contain the
/// defaults. Callers read choices, lists of tables and fields that are `by_hand`.
class FieldReader {
public:
    /// Differences between a table and the description.
    struct Table {
        const char* prefix = ""; // prefix of its keys, such as "am_" for the wave of AM
        bool has_preset = false; // keys that a preset supplies are optional
        std::vector<std::string> without = {}; // keys that do not exist in this table
    };
    FieldReader(Reader& reader, const Table& table) : reader_(reader), table_(table) {}

    template <class T>
    void operator()(T& value, const Field& field) {
        if (!*field.key || field.given == Given::by_hand) return;
        for (const std::string& key : table_.without)
            if (key == field.key) return;
        const std::string key = std::string(table_.prefix) + field.key;
        if (!field.applies) {
            if (reader_.has(key) && *field.only_with)
                reader_.error(key, std::string("applies only with ") + field.only_with);
            return;
        }
        if (is_required(field) && !reader_.has(key)) reader_.missing(key);
        read(value, key, field.range, field);
    }
    template <class T>
    void choice(T&, const Field&) {}
    template <class T>
    void each(const char*, T&, const Field&) {}
    template <class T>
    void maybe(const char*, T&) {}
    void section(const char*) {}
    void key(const Field&) {}
    void key(const auto&, const Field&) {}

private:
    bool is_required(const Field& field) const {
        return field.given == Given::required ||
               (field.given == Given::preset && !table_.has_preset);
    }

    void read(double& value, const std::string& key, const Range& range, const Field& field);
    void read(std::optional<double>& value, const std::string& key, const Range& range,
              const Field& field);
    template <std::integral Integer>
    void read(Integer& value, const std::string& key, const Range& range, const Field&) {
        if (const auto found = find_integer(reader_, key, range))
            value = static_cast<Integer>(*found);
    }
    void read(bool& value, const std::string& key, const Range&, const Field&) {
        value = reader_.find_flag(key).value_or(value);
    }
    void read(Switch& value, const std::string& key, const Range&, const Field&) {
        value = reader_.find_flag(key).value_or(value == Switch::on) ? Switch::on : Switch::off;
    }
    template <Named E>
    void read(E& value, const std::string& key, const Range&, const Field&) {
        constexpr auto names = names_of(std::type_identity<E>{});
        const std::vector<std::string> allowed(names.begin(), names.end());
        const auto name = reader_.find_choice(key, allowed);
        for (std::size_t i = 0; i < allowed.size(); ++i)
            if (name == allowed[i]) value = static_cast<E>(i);
    }
    void read(std::string& value, const std::string& key, const Range&, const Field&) {
        value = reader_.find_word(key).value_or(value);
    }
    void read(Vec2& value, const std::string& key, const Range& range, const Field& field);
    void read(std::optional<Vec2>& value, const std::string& key, const Range&, const Field&) {
        if (reader_.has(key)) value = reader_.point(key);
    }
    void read(Vec3& value, const std::string& key, const Range& range, const Field&) {
        value = read_triple(reader_, key, range);
    }
    void read(std::vector<double>& values, const std::string& key, const Range& range,
              const Field& field);
    // Always `by_hand`.
    template <class T>
    void read(std::vector<T>&, const std::string&, const Range&, const Field&) {}
    template <class T>
    void read(std::shared_ptr<const T>&, const std::string&, const Range&, const Field&) {}

    Reader& reader_;
    const Table& table_;
};

/// Reads the described fields into `options`; its initial values are the defaults.
template <class Options>
void read_fields(Reader& reader, Options& options, const FieldReader::Table& table = {}) {
    FieldReader walk(reader, table);
    walk_fields(walk, options);
}

/// The names of a variant's alternatives.
template <class Variant>
std::vector<std::string> alternative_names() {
    std::vector<std::string> names;
    for_each_alternative(std::type_identity<Variant>{}, [&](const auto& alternative) {
        names.emplace_back(alternative_name<std::decay_t<decltype(alternative)>>());
    });
    return names;
}

/// Reads the fields of the alternative with that name; nothing if there is none.
template <class Variant>
std::optional<Variant> read_alternative(Reader& reader, const std::string& name,
                                        const FieldReader::Table& table = {}) {
    std::optional<Variant> read;
    for_each_alternative(std::type_identity<Variant>{}, [&](auto alternative) {
        if (name != alternative_name<decltype(alternative)>()) return;
        read_fields(reader, alternative, table);
        read = std::move(alternative);
    });
    return read;
}

} // namespace shearwake::config
