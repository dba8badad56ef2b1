// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.hpp"

#include "base/hash.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake {

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
    std::optional<std::string> best;
    // Accept a candidate if at most a third of the letters (and at least two) differ.
    std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
    for (const std::string& candidate : candidates) {
        const std::size_t distance = edit_distance(word, candidate);
        if (distance < best_distance) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

std::string quoted_list(std::span<const std::string> items, std::string_view conjunction) {
    std::string text;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i > 0) text += i + 1 == items.size() ? fmt::format(" {} ", conjunction) : ", ";
        text += fmt::format("\"{}\"", items[i]);
    }
    return text;
}

bool is_file_name(std::string_view name) {
    const auto is_safe = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               c == '-' || c == '_' || c == '.';
    };
    return !name.empty() && name.front() != '.' && name.front() != '-' &&
           name.size() <= longest_file_name && std::all_of(name.begin(), name.end(), is_safe);
}

std::string exact(double value) {
    return fmt::format("{}", value); // fmt prints the shortest text that round-trips
}

std::string hex(std::uint64_t value) {
    return fmt::format("{:016x}", value);
}

} // namespace shearwake
