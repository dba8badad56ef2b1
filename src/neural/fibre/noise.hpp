// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace shearwake::neural {

// Counter-based random numbers, which depend on their arguments alone and therefore neither on the
// rank nor on the order of calls: Philox 4x32-10 of Random123 (Salmon et al., SC 2011). Not
// collective.

/// Two independent standard normal numbers (Box and Muller).
std::array<double, 2> two_normals(std::uint64_t key, std::uint32_t stream, std::uint64_t counter);

/// Two independent uniform numbers in (0, 1).
std::array<double, 2> two_uniforms(std::uint64_t key, std::uint32_t stream, std::uint64_t counter);

} // namespace shearwake::neural
