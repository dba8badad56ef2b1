// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checksum/sealed_text.hpp"

#include "base/hash.hpp"

#include <xxhash.h>

namespace shearwake::storage {
namespace {

constexpr std::string_view member = ",\"checksum\":\"";
constexpr std::size_t digits = 16;
constexpr std::string_view white = " \t\r\n";

/// Position of the closing brace of the object; npos without one.
std::size_t end_of_object(std::string_view text) {
    const std::size_t at = text.find_last_not_of(white);
    return at != std::string_view::npos && text[at] == '}' ? at : std::string_view::npos;
}

} // namespace

std::string seal(std::string_view text) {
    const std::size_t end = end_of_object(text);
    std::string sealed(text.substr(0, end));
    sealed += member;
    sealed += hex(XXH3_64bits(text.data(), text.size()));
    sealed += '"';
    return sealed += text.substr(end);
}

std::optional<std::string> unseal(std::string_view text) {
    const std::size_t end = end_of_object(text);
    const std::size_t length = member.size() + digits + 1;
    if (end == std::string_view::npos || end < length) return std::nullopt;
    std::string plain(text.substr(0, end - length));
    plain += text.substr(end);
    return seal(plain) == text ? std::optional(plain) : std::nullopt;
}

} // namespace shearwake::storage
