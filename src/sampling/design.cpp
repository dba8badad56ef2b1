// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/design.hpp"

#include <Random123/philox.h>
#include <Random123/uniform.hpp>
#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace shearwake::sampling {

Design design_of(const UncertainPlan& plan) {
    const auto named = []<class E>(E, const std::string& name) {
        const auto names = names_of(std::type_identity<E>{});
        return static_cast<E>(std::ranges::find(names, name) - names.begin());
    };
    return {.sampling = named(Sampling{}, plan.sampling),
            .analysis = named(Analysis{}, plan.analysis),
            .samples = plan.samples,
            .keys = plan.keys.size(),
            .seed = plan.seed};
}

std::size_t rows_per_sample(const Design& design) {
    switch (design.analysis) {
    case Analysis::sobol_indices:
        return design.keys + 2;
    case Analysis::morris:
        return design.keys + 1;
    case Analysis::distribution:
        break;
    }
    return 1;
}

Points design_points(const Design& design) {
    if (design.analysis == Analysis::distribution)
        return unit_points(design.sampling, design.samples, design.keys, design.seed);
    const auto keys = static_cast<std::ptrdiff_t>(design.keys);
    Points rows;
    for (const auto& pair :
         unit_points(design.sampling, design.samples, 2 * design.keys, design.seed)) {
        const std::vector<double> a(pair.begin(), pair.begin() + keys);
        const std::vector<double> b(pair.begin() + keys, pair.end());
        rows.push_back(a);
        if (design.analysis == Analysis::sobol_indices) rows.push_back(b);
        for (std::size_t i = 0; i < design.keys; ++i) {
            rows.push_back(a);
            rows.back()[i] = b[i];
        }
    }
    return rows;
}

namespace {

// Streams of random numbers; the dimension is added.
constexpr std::uint32_t shifts = 1U << 16, jitters = 2U << 16, permutations = 3U << 16,
                        independent = 4U << 16;

/// The middle of one of 2^53 equal intervals of (0, 1).
double open_fraction(std::uint64_t bits) {
    return std::min(std::ldexp(static_cast<double>(bits >> 11) + 0.5, -53),
                    1.0 - std::numeric_limits<double>::epsilon() / 2.0);
}

Points sobol_points(std::size_t count, std::size_t dimensions, std::uint64_t seed) {
    boost::random::sobol generator(dimensions); // begins with the second point of the sequence
    Points points(count, std::vector<double>(dimensions));
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t d = 0; d < dimensions; ++d) {
            const std::uint64_t digits = i == 0 ? 0 : generator();
            points[i][d] = open_fraction(
                digits ^ random_bits(seed, shifts + static_cast<std::uint32_t>(d), 0));
        }
    return points;
}

/// The coordinates of one dimension. `cells` are the intervals of the points so far; a doubling
/// splits each of them, and the new points take the free halves in random order.
std::vector<double> nested_coordinates(std::size_t count, std::uint32_t dimension,
                                       std::uint64_t seed) {
    std::vector<double> x = {random_uniform(seed, jitters + dimension, 0)};
    for (std::uint32_t level = 0; x.size() < count; ++level) {
        const std::size_t n = x.size();
        std::vector<std::size_t> half(n); // of each interval: the one that is free
        for (const double at : x) {
            const double place = at * static_cast<double>(n);
            const auto cell = std::min(n - 1, static_cast<std::size_t>(place));
            half[cell] = place - static_cast<double>(cell) < 0.5 ? 1 : 0;
        }
        const std::vector<std::size_t> order =
            random_permutation(n, seed, (permutations + dimension) | level << 20U);
        for (const std::size_t cell : order) {
            const double within = random_uniform(seed, jitters + dimension, x.size());
            x.push_back((static_cast<double>(2 * cell + half[cell]) + within) /
                        static_cast<double>(2 * n));
        }
    }
    x.resize(count);
    return x;
}

Points latin_points(std::size_t count, std::size_t dimensions, std::uint64_t seed) {
    Points points(count, std::vector<double>(dimensions));
    for (std::size_t d = 0; d < dimensions; ++d) {
        const std::vector<double> x =
            nested_coordinates(count, static_cast<std::uint32_t>(d), seed);
        for (std::size_t i = 0; i < count; ++i)
            points[i][d] = x[i];
    }
    return points;
}

Points random_points(std::size_t count, std::size_t dimensions, std::uint64_t seed) {
    Points points(count, std::vector<double>(dimensions));
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t d = 0; d < dimensions; ++d)
            points[i][d] = random_uniform(seed, independent + static_cast<std::uint32_t>(d), i);
    return points;
}

} // namespace

Points unit_points(Sampling sampling, std::size_t count, std::size_t dimensions,
                   std::uint64_t seed) {
    if (count == 0 || dimensions == 0) return {};
    switch (sampling) {
    case Sampling::sobol:
        return sobol_points(count, dimensions, seed);
    case Sampling::latin_hypercube:
        return latin_points(count, dimensions, seed);
    case Sampling::random:
        break;
    }
    return random_points(count, dimensions, seed);
}

std::uint64_t random_bits(std::uint64_t seed, std::uint32_t stream, std::uint64_t counter) {
    const auto low = [](std::uint64_t word) { return static_cast<std::uint32_t>(word); };
    const auto bits = r123::Philox4x32{}({{low(counter), low(counter >> 32), stream, 1}},
                                         {{low(seed), low(seed >> 32)}});
    return static_cast<std::uint64_t>(bits[1]) << 32 | bits[0];
}

double random_uniform(std::uint64_t seed, std::uint32_t stream, std::uint64_t counter) {
    return r123::u01<double>(random_bits(seed, stream, counter));
}

std::vector<std::size_t> random_permutation(std::size_t n, std::uint64_t seed,
                                            std::uint32_t stream) {
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = n; i > 1; --i) // Fisher and Yates
        std::swap(order[i - 1], order[random_bits(seed, stream, i) % i]);
    return order;
}

} // namespace shearwake::sampling
