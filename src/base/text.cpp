// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <unistd.h>

namespace shearwake {

namespace {

std::string lower_case(std::string_view text) {
    std::string lower(text);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return lower;
}

} // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // Optimal string alignment with three rolling rows of the dynamic-programming table.
    std::vector<std::size_t> before(b.size() + 1), previous(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j)
        previous[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = previous[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({previous[j] + 1, row[j - 1] + 1, replaced});
            const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
        }
        before = previous;
        previous = row;
    }
    return previous[b.size()];
}

std::optional<std::string> nearest(std::string_view word, std::span<const std::string> candidates) {
    const std::string typed = lower_case(word);
    std::optional<std::string> best;
    // Accept a candidate if at most a third of the letters (and at least two) differ.
    std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
    for (const std::string& candidate : candidates) {
        const std::size_t distance = edit_distance(typed, lower_case(candidate));
        if (distance < best_distance) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

std::optional<std::string> with_decimal_point(std::string_view text) {
    const auto comma = text.find(',');
    if (comma == std::string_view::npos) return std::nullopt;
    std::string number(text);
    number[comma] = '.';
    const auto is_digit = [&](std::size_t at) {
        return at < number.size() && std::isdigit(static_cast<unsigned char>(number[at]));
    };
    const std::size_t first = !number.empty() && (number[0] == '-' || number[0] == '+') ? 1 : 0;
    if (!is_digit(first) || !is_digit(comma + 1)) return std::nullopt;
    char* end = nullptr;
    std::strtod(number.c_str(), &end);
    return *end == '\0' ? std::optional(number) : std::nullopt;
}

std::string quoted_list(std::span<const std::string> items, std::string_view conjunction) {
    std::string text;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i > 0) text += i + 1 == items.size() ? fmt::format(" {} ", conjunction) : ", ";
        text += fmt::format("\"{}\"", items[i]);
    }
    return text;
}

std::string counted(std::ptrdiff_t count, std::string_view noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

bool is_file_name(std::string_view name) {
    const auto is_safe = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_' || c == '.';
    };
    return !name.empty() && name.front() != '.' && name.front() != '-' &&
           name.size() <= longest_file_name && std::all_of(name.begin(), name.end(), is_safe);
}

std::string coloured(const std::string& given, std::FILE* stream) {
    const std::string text = printable(given);
    const char* none = std::getenv("NO_COLOR");
    if (::isatty(::fileno(stream)) == 0 || (none != nullptr && *none != '\0')) return text;
    std::string made;
    for (std::size_t i = 0, last = 0; i < text.size(); ++i) {
        const std::string_view before = std::string_view(text).substr(last, i - last),
                               rest = std::string_view(text).substr(i);
        const bool begins = i == 0 || before.ends_with('\n') || before.ends_with(": ");
        const char* word = rest.starts_with("error:") ? "error:" : "warning:";
        if (!begins || !rest.starts_with(word)) {
            made += text[i];
            continue;
        }
        made += fmt::format("\x1b[{}m{}\x1b[0m", word[0] == 'e' ? "1;31" : "1;33", word);
        last = i + std::string_view(word).size();
        i = last - 1;
    }
    return made;
}

std::string duration_text(double seconds) {
    const auto s = std::llround(std::clamp(seconds, 0.0, 1e15));
    if (s < 100) return fmt::format("{} s", s);
    if (s < 6000) return fmt::format("{} min {:02} s", s / 60, s % 60);
    return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

std::string hours_and_minutes(double seconds) {
    const auto minutes = std::llround(std::ceil(std::clamp(seconds, 0.0, 1e15) / 60.0));
    return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

std::string exact(double value) {
    return fmt::format("{}", value); // fmt prints the shortest text that round-trips
}

std::string hex(std::uint64_t value) {
    return fmt::format("{:016x}", value);
}

namespace {

/// Length in bytes of the control character at the start of the text; 0 if there is none.
std::size_t control_character(std::string_view text) {
    const auto at = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
    };
    if (at(0) < 0x20 || at(0) == 0x7f) return 1;
    if (at(0) == 0xc2 && at(1) >= 0x80 && at(1) <= 0x9f) return 2;
    if (at(0) != 0xe2) return 0;
    const bool turns = (at(1) == 0x80 && at(2) >= 0xaa && at(2) <= 0xae) ||
                       (at(1) == 0x81 && at(2) >= 0xa6 && at(2) <= 0xa9);
    return turns ? 3 : 0;
}

} // namespace

bool has_control_characters(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i)
        if (control_character(text.substr(i)) > 0) return true;
    return false;
}

std::string printable(std::string_view text) {
    std::string clean;
    for (std::size_t i = 0; i < text.size();) {
        const bool breaks = text[i] == '\n' || text.substr(i, 2) == "\r\n";
        const std::size_t length = breaks ? 0 : control_character(text.substr(i));
        clean += length > 0 ? '?' : text[i];
        i += std::max<std::size_t>(length, 1);
    }
    return clean;
}

} // namespace shearwake
