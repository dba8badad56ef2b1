#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake {

/// Fewest insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate a mistyped `word` most likely meant, if any is near enough to be worth saying.
std::optional<std::string> nearest(std::string_view word, std::span<const std::string> candidates);

/// `a, b and c` with each item in double quotes.
std::string quoted_list(std::span<const std::string> items, std::string_view conjunction = "or");

/// What may become the name of a file or folder and stays where it is put: 1 to
/// longest_file_name letters, digits, "-", "_" and ".", not starting with ".".
bool is_file_name(std::string_view name);
inline constexpr std::size_t longest_file_name = 100;

/// Shortest text that reads back as the same double.
std::string exact(double value);

} // namespace shearwake
