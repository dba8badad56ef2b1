// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simd/kernels.hpp"

#include <random>
#include <vector>

namespace shearwake::test {

inline std::vector<simd::InstructionSet> sets_of_this_processor() {
    using simd::InstructionSet;
    std::vector<InstructionSet> sets;
    for (const auto set : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512})
        if (set <= simd::best_instruction_set()) sets.push_back(set);
    return sets;
}

/// Between -1 and 1.
template <class Numbers>
Numbers random_numbers(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    Numbers numbers(count);
    for (auto& number : numbers)
        number = static_cast<typename Numbers::value_type>(uniform(random));
    return numbers;
}

} // namespace shearwake::test
