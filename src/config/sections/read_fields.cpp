// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_fields.hpp"

#include "base/units.hpp"
#include "config/document/key_range.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {

std::string in_milli(double x_SI) {
    return fmt::format("{:.6g}", 1e3 * x_SI);
}

double read_optional_number(Reader& reader, const Field& field) {
    const auto unit = unit_of(field.key);
    const double fallback = std::stod(field.fallback) * (unit ? unit->to_SI : 1.0);
    return reader.number_or(field.key, fallback, field.range);
}

std::string read_optional_word(Reader& reader, const Field& field) {
    const std::vector<std::string> words = words_of(field);
    return reader.choice_or(field.key, words.front(), words);
}

std::optional<double> find_integer(Reader& reader, std::string_view key, const Range& range) {
    const auto number = reader.find_number(key, range);
    if (!number) return std::nullopt;
    const double below = std::floor(*number);
    if (below != *number)
        reader.error(key, fmt::format("must be a whole number, but is {:.6g}", *number));
    return below;
}

std::optional<std::array<int, 2>> find_integer_pair(Reader& reader, std::string_view key,
                                                    const Range& range, std::string_view meaning) {
    const auto numbers = reader.find_numbers(key, range);
    if (!numbers) return std::nullopt;
    const auto is_integer = [](double number) { return number == std::floor(number); };
    if (numbers->size() == 2 && std::ranges::all_of(*numbers, is_integer))
        return std::array{static_cast<int>((*numbers)[0]), static_cast<int>((*numbers)[1])};
    reader.error(key, fmt::format("must be two whole numbers{}", meaning));
    return std::nullopt;
}

Vec3 read_triple(Reader& reader, std::string_view key, const Range& range) {
    const auto values = reader.find_numbers(key, range);
    if (values && values->size() != 3)
        reader.error(key,
                     fmt::format("must be three numbers [x, y, z], but has {}", values->size()));
    return values && values->size() == 3 ? Vec3{(*values)[0], (*values)[1], (*values)[2]}
                                         : Vec3{1.0, 1.0, 1.0};
}

void FieldReader::read(double& value, const std::string& key, const Range& range,
                       const Field& field) {
    // A valid substitute after an error: required keys have no default.
    value = reader_.number_or(key, is_required(field) ? 1.0 : value, range);
}

void FieldReader::read(std::optional<double>& value, const std::string& key, const Range& range,
                       const Field& field) {
    if (field.given == Given::automatic) {
        const NodePtr node = reader_.node(key);
        const auto* word = node ? std::get_if<std::string>(&node->value) : nullptr;
        if (word && *word == "auto") return;
    }
    value = reader_.find_number(key, range);
}

void FieldReader::read(std::vector<double>& values, const std::string& key, const Range& range,
                       const Field& field) {
    const auto found = reader_.find_numbers(key, range);
    if (!found) return;
    values = *found;
    const std::size_t least = field.least_count, most = field.most_count;
    if (values.size() < least || (most > 0 && values.size() > most))
        reader_.error(key,
                      fmt::format("must contain {} {} number{}, but has {}",
                                  values.size() < least ? "at least" : "at most",
                                  values.size() < least ? least : most,
                                  values.size() < least && least == 1 ? "" : "s", values.size()));
}

void FieldReader::read(Vec2& value, const std::string& key, const Range& range,
                       const Field& field) {
    // A missing required point has been reported.
    if (is_required(field))
        value = reader_.has(key) ? reader_.point(key, range) : Vec2{1.0, 1.0};
    else
        value = reader_.point_or(key, value);
}

} // namespace shearwake::config
