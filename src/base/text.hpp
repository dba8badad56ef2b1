// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <istream>
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

/// "1 case", "2 cases".
std::string counted(std::ptrdiff_t count, std::string_view noun);
std::string counted(std::integral auto count, std::string_view noun) {
    return counted(static_cast<std::ptrdiff_t>(count), noun);
}

/// Whether `name` is safe as the name of a file or folder: 1 to longest_file_name letters, digits,
/// "-", "_" and ".", not starting with "." or "-".
bool is_file_name(std::string_view name);
inline constexpr std::size_t longest_file_name = 100;

/// The printable() text with the words "error:" and "warning:" in colour where they begin a line or
/// follow a place, if `stream` is a terminal and the environment variable NO_COLOR is empty.
std::string coloured(const std::string& given, std::FILE* stream);

/// A duration for users: "42 s", "5 min 07 s" or "3 h 20 min".
std::string duration_text(double seconds);

/// A duration of any length: "3 h 20 min", rounded up to minutes.
std::string hours_and_minutes(double seconds);

/// Shortest decimal text that reads back as the same double.
std::string exact(double value);

/// FNV-1a hash with 64 bits (Fowler, Noll, Vo). The result is the same on every machine and in
/// every build.
constexpr std::uint64_t stable_hash(std::string_view text,
                                    std::uint64_t seed = 14695981039346656037ULL) {
    std::uint64_t hash = seed;
    for (const char c : text) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 1099511628211ULL;
    }
    return hash;
}

/// FNV-1a hash of the bytes of numbers.
inline std::uint64_t stable_hash(std::span<const double> values,
                                 std::uint64_t seed = 14695981039346656037ULL) {
    std::uint64_t hash = seed;
    for (const std::byte byte : std::as_bytes(values)) {
        hash ^= std::to_integer<unsigned char>(byte);
        hash *= 1099511628211ULL;
    }
    return hash;
}

/// The value as 16 hexadecimal digits.
std::string hex(std::uint64_t value);

/// Reads the next line, or the text up to the next `end`; false at the end of the stream. Rethrows
/// an exception that interrupted the reading, such as std::bad_alloc, which std::getline() reports
/// as the end of the stream, so that a file would be read in part. From then on the stream throws
/// such exceptions in all operations. Not collective.
inline bool next_line(std::istream& in, std::string& line, char end = '\n') {
    in.exceptions(std::ios::badbit);
    return static_cast<bool>(std::getline(in, line, end));
}

/// Whether the text contains characters that a terminal would interpret: control characters of
/// ASCII, including line breaks, and of Unicode (U+0080 to U+009F), and characters that change the
/// direction of writing.
bool has_control_characters(std::string_view text);

/// The text with every such character replaced by a question mark. Line breaks ("\n" and "\r\n")
/// are kept.
std::string printable(std::string_view text);

} // namespace shearwake
