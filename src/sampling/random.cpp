// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/random.hpp"

#include <Random123/philox.h>
#include <Random123/uniform.hpp>
#include <numeric>
#include <utility>

namespace shearwake::sampling {

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
