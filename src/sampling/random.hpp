// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace shearwake::sampling {

/// 64 random bits that depend on the arguments alone: Philox 4x32-10 of Random123.
std::uint64_t random_bits(std::uint64_t seed, std::uint32_t stream, std::uint64_t counter);

/// A uniform number in (0, 1).
double random_uniform(std::uint64_t seed, std::uint32_t stream, std::uint64_t counter);

/// A random permutation of 0 ... n - 1.
std::vector<std::size_t> random_permutation(std::size_t n, std::uint64_t seed,
                                            std::uint32_t stream);

} // namespace shearwake::sampling
