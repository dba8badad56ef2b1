// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace shearwake {

/// A text is not JSON, or a value has another type or other members than expected.
class JsonError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A JSON value. Its destruction needs no memory. One translation unit reads and writes it by
/// nlohmann-json, whose header costs each one that includes it seconds.
class Json {
public:
    struct Member;
    using Array = std::vector<Json>;
    using Object = std::vector<Member>; // in the order of insertion, each key once

    Json() noexcept; // null
    Json(std::nullptr_t) noexcept : Json() {}
    Json(bool value);
    Json(std::int64_t value);
    Json(std::uint64_t value);
    template <std::integral T>
    Json(T value)
        : Json(static_cast<
               std::conditional_t<std::unsigned_integral<T>, std::uint64_t, std::int64_t>>(value)) {
    }
    Json(double value);
    Json(std::string text);
    Json(std::string_view text) : Json(std::string(text)) {}
    Json(const char* text) : Json(std::string(text)) {}
    Json(const std::vector<std::string>& texts);
    Json(const std::vector<double>& numbers);
    Json(const void*) = delete; // it would become a bool
    /// An object if each value is an array of two that begins with a text; otherwise an array.
    Json(std::initializer_list<Json> values);
    Json(const Json& other);
    Json(Json&& other) noexcept;
    Json& operator=(Json other) noexcept; // a copy, since other may be a part of this
    ~Json();
    static Json array(std::initializer_list<Json> values = {});
    static Json object() { return Json(std::initializer_list<Json>{}); }

    /// Throws JsonError if the text is not one value, or if more than 200 values are nested.
    static Json parse(std::string_view text);
    /// Null if the text is not one value. Values in more than `deepest` others are discarded while
    /// they are read.
    static Json parse_or_null(std::string_view text, std::size_t deepest = most_nested);

    /// On one line, or on several with an indent of at least 0. Numbers have as many digits as are
    /// needed to read the same one, and become null if they are not finite. Throws an exception if
    /// a text is not UTF-8.
    std::string dump(int indent = -1) const;
    /// The same with invalid UTF-8 (in paths or system messages) replaced.
    std::string text(int indent = -1) const;

    bool is_null() const { return value_.index() == 0; }
    bool is_integer() const { return value_.index() == 2 || value_.index() == 3; }
    bool is_float() const { return value_.index() == 4; }
    bool is_number() const { return is_integer() || is_float(); }
    bool is_string() const { return value_.index() == 5; }
    bool is_array() const { return value_.index() == 6; }
    bool is_object() const { return value_.index() == 7; }
    bool is_structured() const { return is_array() || is_object(); }
    /// Numbers are equal if their values are.
    bool operator==(const Json& other) const;

    /// As bool, int, long, std::size_t, double or std::string, or as a vector of the last two.
    /// Throws JsonError for other values.
    template <class T>
    T get() const;
    /// That of a member; `fallback` without it.
    template <class T>
    T value(std::string_view key, T fallback) const {
        const Json* found = find(key);
        return found ? found->get<T>() : fallback;
    }

    /// Of arrays; other values throw JsonError, but push_back() makes an array of null.
    Json* begin() { return elements().data(); }
    Json* end() { return begin() + size(); }
    const Json* begin() const { return elements().data(); }
    const Json* end() const { return begin() + size(); }
    const Json& at(std::size_t index) const;
    Json& at(std::size_t index) { return const_cast<Json&>(std::as_const(*this).at(index)); }
    void push_back(Json value);

    /// Of objects; other values throw JsonError, but find() returns null, and operator[], which
    /// adds null for a key without a member, makes an object of null.
    const Object& items() const;
    Object& items() { return const_cast<Object&>(std::as_const(*this).items()); }
    Json& operator[](std::string_view key);
    const Json& at(std::string_view key) const;
    Json& at(std::string_view key) { return const_cast<Json&>(std::as_const(*this).at(key)); }
    const Json* find(std::string_view key) const;
    Json* find(std::string_view key) { return const_cast<Json*>(std::as_const(*this).find(key)); }
    bool contains(std::string_view key) const { return find(key) != nullptr; }
    void erase(std::string_view key);
    void update(const Json& members);

    /// Number of elements or members; 0 for null, and 1 for others.
    std::size_t size() const;
    bool empty() const { return size() == 0; }

private:
    static constexpr std::size_t most_nested = 200; // they are destroyed by recursion
    struct Layout;
    void write(std::string& out, const Layout& layout, std::size_t level) const;
    const Array& elements() const;
    Array& elements() { return const_cast<Array&>(std::as_const(*this).elements()); }

    std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, Array,
                 Object>
        value_; // std::uint64_t only where it is too large for std::int64_t
};

struct Json::Member {
    std::string key;
    Json value;
    bool operator==(const Member&) const = default;
};

/// Version of the documents that commands print with --json. A change that removes or renames a
/// member, or changes its meaning, increases it. docs/reference/json-output.md describes them.
inline constexpr int json_schema_version = 2;

/// The text of such a document: an object with `schema`, `command`, and then `members`. Numbers
/// that are not finite become null, and invalid UTF-8 is replaced.
std::string json_document(std::string_view command, const Json& members);

} // namespace shearwake
