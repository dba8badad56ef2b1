// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace shearwake {

/// Number of doubles in a Block, which kernels process together.
inline constexpr std::ptrdiff_t lane_count = 8;

/// Eight doubles (one 64-byte cache line): the unit of storage of all data that is processed lane
/// by lane. The layout is the same on every CPU; kernels (simd/kernels.hpp) split it into vectors
/// of their own width. Block is an aggregate: `Block b{}` is zero.
struct alignas(64) Block {
    double lane[lane_count];

    [[gnu::always_inline]] double& operator[](std::ptrdiff_t i) { return lane[i]; }
    [[gnu::always_inline]] double operator[](std::ptrdiff_t i) const { return lane[i]; }
};

/// The same value in every lane.
[[gnu::always_inline]] inline Block block_of(double value) {
    return {{value, value, value, value, value, value, value, value}};
}

/// Views blocks as the doubles that they consist of.
[[gnu::always_inline]] inline double* scalars(Block* blocks) {
    return reinterpret_cast<double*>(blocks);
}
[[gnu::always_inline]] inline const double* scalars(const Block* blocks) {
    return reinterpret_cast<const double*>(blocks);
}

/// Sum of the eight lanes. The order of additions does not depend on the vector width, so the
/// result has the same bits on every CPU.
[[gnu::always_inline]] inline double sum_of(const Block& b) {
    return ((b[0] + b[1]) + (b[2] + b[3])) + ((b[4] + b[5]) + (b[6] + b[7]));
}

/// to += factor * x. Intended for a few blocks; use a kernel for long arrays.
[[gnu::always_inline]] inline void add_scaled(double factor, const Block& x, Block& to) {
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
        to[lane] += factor * x[lane];
}

} // namespace shearwake
