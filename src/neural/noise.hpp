#pragma once

#include <array>
#include <cstdint>

namespace shearwake::neural {

// Random numbers that are a function of what they belong to, whatever rank asks for them and in
// which order: Philox 4x32-10 of Random123 (Salmon et al., SC 2011).

/// Two standard normal numbers (Box and Muller).
std::array<double, 2> two_normals(std::uint64_t key, std::uint32_t stream, std::uint64_t counter);

/// Two numbers in (0, 1).
std::array<double, 2> two_uniforms(std::uint64_t key, std::uint32_t stream, std::uint64_t counter);

} // namespace shearwake::neural
