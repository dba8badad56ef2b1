// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"

#include <array>
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
constexpr std::array<const char*, 3> names_of(std::type_identity<Sampling>) {
    return {"sobol", "latin-hypercube", "random"};
}

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

/// What a sample is for, which determines its points.
enum class Analysis { distribution, sobol_indices, morris };
constexpr std::array<const char*, 3> names_of(std::type_identity<Analysis>) {
    return {"distribution", "sobol-indices", "morris"};
}

/// A design of `samples` blocks in `keys` dimensions. Row `sample * rows_per_sample + r` is row r
/// of the block; extending a design appends blocks.
struct Design {
    Sampling sampling = Sampling::sobol;
    Analysis analysis = Analysis::distribution;
    std::size_t samples = 0;
    std::size_t keys = 0;
    std::uint64_t seed = 0;
};

/// The design of a plan.
Design design_of(const UncertainPlan& plan);

/// The number of rows per block:
/// * distribution: 1, the point.
/// * sobol_indices: keys + 2, the design of Saltelli et al. (2010): A, B, and A with coordinate i
/// of
///   B for each key i.
/// * morris: keys + 1, the radial design of Campolongo, Saltelli and Cariboni (2011): A, and A with
///   coordinate i of B for each key i.
std::size_t rows_per_sample(const Design& design);

/// The rows of the design in the unit cube. A and B are the two halves of a point in twice as many
/// dimensions.
Points design_points(const Design& design);

} // namespace shearwake::sampling
