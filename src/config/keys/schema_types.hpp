// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/json.hpp"
#include "base/units.hpp"
#include "base/vectors.hpp"
#include "problem/case/afferents.hpp"

#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::config {

// The JSON Schema of jobs, and that of the value of one key.

/// The document of job_schema().
Json schema_of_jobs();

/// A number or an integer with the bounds of the key.
Json number(const Field& field);
Json integer(const Field& field);
Json list_of(const Json& item, std::size_t least = 0, std::size_t most = 0);
Json one_of(const std::vector<std::string>& words);
/// The schema of a type name in a description, see Field::type.
Json named_type(const Field& field);

template <class T>
Json type_of(const T&, const Field& field) {
    if constexpr (Named<T>) {
        const auto names = names_of(std::type_identity<T>{});
        return one_of({names.begin(), names.end()});
    } else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, Switch>)
        return {{"type", "boolean"}};
    else if constexpr (std::is_arithmetic_v<T>)
        return std::is_integral_v<T> ? integer(field) : number(field);
    else if constexpr (std::is_same_v<T, Vec2>)
        return list_of(number(field), 2, 2);
    else if constexpr (std::is_same_v<T, Vec3>)
        return list_of(number(field), 3, 3);
    else
        return {{"type", "string"}}; // words, and names of files
}
template <class T>
Json type_of(const std::optional<T>&, const Field& field) {
    return type_of(T{}, field);
}
inline Json type_of(const std::vector<ListedAfferent>&, const Field&) {
    return {{"type", "string"}};
}
template <class T>
Json type_of(const std::vector<T>&, const Field& field) {
    return list_of(type_of(T{}, field), field.least_count, field.most_count);
}

/// The default in the unit of the key; null where there is none that can be stated.
inline Json shown(double value, const char* key) {
    const auto unit = unit_of(key);
    const double given = unit ? value / unit->to_SI : value;
    return std::isfinite(given) ? Json(std::stod(fmt::format("{:.6g}", given))) : Json();
}
inline Json shown(Switch value, const char*) {
    return value == Switch::on;
}
template <class T>
requires std::integral<T> || std::same_as<T, std::string> Json shown(const T& value, const char*) {
    return value;
}
inline Json shown(Vec2 at, const char* key) {
    return {shown(at.x, key), shown(at.y, key)};
}
template <Named E>
Json shown(const E& value, const char*) {
    return name_in_text(value);
}
template <class T>
Json shown(const T&, const char*) {
    return {};
}

} // namespace shearwake::config
