// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// Minimum number of insertions, deletions, replacements and transpositions of adjacent characters
/// that turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate closest to a mistyped `word`, if one is close enough to be suggested. Case is
/// ignored.
std::optional<std::string> nearest(std::string_view word, std::span<const std::string> candidates);

/// "1.5" for "1,5"; nothing if `text` is not a number with a decimal comma.
std::optional<std::string> with_decimal_point(std::string_view text);

/// `a, b and c` with each item in double quotes.
std::string quoted_list(std::span<const std::string> items, std::string_view conjunction = "or");

/// Whether `name` is safe as the name of a file or folder: 1 to longest_file_name letters, digits,
/// "-", "_" and ".", not starting with "." or "-".
bool is_file_name(std::string_view name);
inline constexpr std::size_t longest_file_name = 100;

/// A duration for users: "42 s", "5 min 07 s" or "3 h 20 min".
std::string duration_text(double seconds);

/// A duration of any length: "3 h 20 min", rounded up to minutes.
std::string hours_and_minutes(double seconds);

/// Shortest decimal text that reads back as the same double.
std::string exact(double value);

} // namespace shearwake
