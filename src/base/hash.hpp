// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace shearwake {

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

} // namespace shearwake
