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

enum class Sampling { sobol, latin_hypercube, random };

/// Points of the unit cube, one row per point.
using Points = std::vector<std::vector<double>>;

/// The first `count` points of a sequence in `dimensions` dimensions, all strictly between 0 and 1.
/// A larger count gives the same points followed by more, so that a sample can be extended.
///
/// * sobol: the Sobol sequence with the direction numbers of Joe and Kuo (2008), from
///   Boost.Random, with a random digital shift. Blocks of 2^k points have one point in each of 2^k
///   equal intervals of every dimension.
/// * latin_hypercube: nested Latin hypercubes (Sallaberry, Helton and Hora 2008). Each doubling
///   fills the empty halves of the intervals in random order, so that the first 2^k points are a
///   Latin hypercube.
/// * random: independent numbers.
Points unit_points(Sampling sampling, std::size_t count, std::size_t dimensions,
                   std::uint64_t seed);

} // namespace shearwake::sampling
