#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace shearwake {

/// FNV-1a, 64 bits (Fowler, Noll, Vo): the same on every machine and in every build.
constexpr std::uint64_t stable_hash(std::string_view text,
                                    std::uint64_t seed = 14695981039346656037ULL) {
    std::uint64_t hash = seed;
    for (const char c : text) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 1099511628211ULL;
    }
    return hash;
}

/// Sixteen hexadecimal digits.
std::string hex(std::uint64_t value);

} // namespace shearwake
