// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <concepts>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

namespace shearwake {

/// Combines one lambda per alternative of a variant: std::visit(overloaded{...}, v).
template <class... F>
struct overloaded : F... {
    using F::operator()...;
};
template <class... F>
overloaded(F...) -> overloaded<F...>;

/// What a number may be, in the unit of its key.
struct Range {
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    bool least_excluded = false;
    bool most_excluded = false;

    static constexpr Range any() { return {}; }
    static constexpr Range above(double least) { return {.least = least, .least_excluded = true}; }
    static constexpr Range at_least(double least) { return {.least = least}; }
    static constexpr Range between(double least, double most) {
        return {.least = least, .most = most};
    }
    static constexpr Range inside(double least, double most) { return {least, most, true, true}; }

    bool contains(double value) const;
    std::string words() const; // "above 0"
};

// The description of an option struct is a function in the file of its folder that ends in _fields,
//
//     template <class Walk, Is<SineGain> Gain>
//     void walk_fields(Walk& walk, Gain& g) {
//         walk(g.frequency_Hz, {.key = "frequency_Hz", .given = Given::required, .meaning =
//         "..."});
//         ...
//     }
//
// Everything else is derived from it: config reads the fields (config/sections/read_fields.hpp),
// canonical_text writes them and case_id hashes this text (problem/case/text_walk.hpp), `shearwake
// keys` lists them (config/keys/key_table.hpp), and a test changes each of them. A walk provides
//
//     walk(field, {...})                a number, word, flag, enumerator, point or list of them
//     walk.choice(variant, {...})       the name of the alternative, then its fields
//     walk.each("table", list, {...})   one table [[table]] per element
//     walk.maybe("table", optional)     a table that may be absent
//     walk.section("table")             the following fields are in [table]
//     walk.key({...})                   a key of job files from which config derives other fields
//     walk.key(example, {...})          the same, with the type and the default of `example`
//
// in the order of the canonical text. The order, the text keys and `in_text` determine the ids of
// cases and must not change. A new field gets `.in_text = value != default`, so that the ids of
// cases that do not use it remain the same.

/// Whether a job must give a key. `preset`: unless a preset does. `automatic`: a number or "auto".
/// `by_hand`: the reader of the table in config/ reads it, since it depends on other keys.
enum class Given { optional, required, preset, automatic, by_hand };

/// How one field appears in job files, in the canonical text and in the reference of keys.
struct Field {
    const char* key = "";  // in job files, with its unit; empty: derived from other keys
    const char* text = ""; // in the canonical text; empty: the key in SI units
    Range range = {};      // of numbers, in the unit of the key
    Given given = Given::optional;
    bool applies = true;        // given the values of the preceding fields
    const char* only_with = ""; // when it applies, as job text; empty: config states it
    bool in_text = true;
    bool flag_in_text = false; // an enumeration of two values is written as false or true
    bool zero_in_text = false; // always written as 0, since all values have the same effect
    std::size_t most_in_text = static_cast<std::size_t>(-1); // a longer list is hashed
    bool own_tables = false; // of a choice: each alternative has a table with its name
    /// In job files, where it differs from the type of the field or there is none: "number",
    /// "integer", "boolean", "word", "word:a|b" (one of these; the first is the default of an
    /// optional key), "file", "name" (of a folder), "words", "pair of words", "point", "points",
    /// "point or word:a|b", "point or triple", "triple", "ends and count", "path", "table",
    /// "tables", "table of numbers".
    const char* type = "";
    const char* fallback = ""; // in the reference, when the default is not the struct's own value
    const char* meaning = "";  // in the reference
    std::size_t least_count = 0, most_count = 0; // of the elements of a list; 0: any number
};

/// `T` is `Struct`, constant or not: one description serves readers and writers.
template <class T, class Struct>
concept Is = std::same_as<std::remove_const_t<T>, Struct>;

/// Some value of a described type; specialised where there is no default constructor.
template <class T>
struct Example {
    static T make() { return T{}; }
};

/// Whether job files and texts have names for the values of an enumeration:
/// `names_of(std::type_identity<E>)` gives them in the order of the enumerators.
template <class E>
concept Named = std::is_enum_v<E> && requires {
    names_of(std::type_identity<E>{});
};

template <Named E>
const char* name_in_text(E value) {
    return names_of(std::type_identity<E>{})[static_cast<std::size_t>(value)];
}

/// The name of a variant's alternative, `T::name`; "" if its fields alone identify it.
template <class T>
constexpr const char* alternative_name() {
    if constexpr (requires { T::name; })
        return T::name;
    else
        return "";
}

/// The name in job files, which may differ: `T::name_in_jobs`.
template <class T>
constexpr const char* name_in_jobs() {
    if constexpr (requires { T::name_in_jobs; })
        return T::name_in_jobs;
    else
        return alternative_name<T>();
}

/// The walk of field_of().
class FieldWalk {
public:
    explicit FieldWalk(std::string_view key) : key_(key) {}
    template <class T>
    void operator()(const T&, const Field& field) {
        key(field);
    }
    void key(const Field& field) {
        if (key_ == field.key) found_ = field;
    }
    template <class T>
    void key(const T&, const Field& field) {
        key(field);
    }
    template <class T>
    void choice(const T&, const Field& field) {
        key(field);
    }
    template <class T>
    void each(const char*, const T&, const Field&) {}
    template <class T>
    void maybe(const char*, const T&) {}
    void section(const char*) {}
    const std::optional<Field>& found() const { return found_; }

private:
    std::string_view key_;
    std::optional<Field> found_;
};

/// A walk over the fields of a struct whose keys have a prefix in the table of another struct,
/// which does not require them: use(value, field).
template <class Use>
struct PrefixedWalk {
    std::string prefix;
    Use use;

    template <class T>
    void operator()(const T& value, Field field) const {
        static std::set<std::string> keys; // a Field only points to its key
        field.key = keys.insert(prefix + field.key).first->c_str();
        if (field.given == Given::required) {
            field.given = Given::by_hand;
            field.fallback = "required";
        }
        use(value, field);
    }
};

template <class Use>
PrefixedWalk(const char*, Use) -> PrefixedWalk<Use>;

/// The description of a key of `Struct` itself, if there is one.
template <class Struct>
std::optional<Field> described_field(std::string_view key) {
    FieldWalk walk(key);
    const Struct example = Example<Struct>::make();
    walk_fields(walk, example);
    return walk.found();
}

/// The description of a key, for a reader that interprets the key itself. Throws std::logic_error
/// if the key is not described.
template <class Struct>
Field field_of(std::string_view key) {
    const auto found = described_field<Struct>(key);
    if (!found) throw std::logic_error("no description of " + std::string(key));
    return *found;
}

template <class Struct>
Range range_of(std::string_view key) {
    return field_of<Struct>(key).range;
}

/// Calls `use` with an example of each alternative in turn.
template <class... T>
void for_each_alternative(std::type_identity<std::variant<T...>>, const auto& use) {
    (use(Example<T>::make()), ...);
}

} // namespace shearwake
