// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/parts.hpp"
#include "simd/vector.hpp"

// For kernels only: access to blocks by vectors. A slice is the part of a block that fits into one
// vector.

namespace shearwake::spectral {
namespace { // NOLINT(cert-dcl59-cpp): see simd/vector.hpp

using simd::Vector;
using simd::width;

inline constexpr std::ptrdiff_t slices = lane_count / width;

[[gnu::always_inline]] inline Vector get(const Block& block, std::ptrdiff_t slice) {
    return simd::load_aligned(block.lane + slice * width);
}
[[gnu::always_inline]] inline void set(Block& block, std::ptrdiff_t slice, Vector value) {
    simd::store_aligned(value, block.lane + slice * width);
}

/// A slice of the four parts of an unknown.
struct Value {
    Vector part[parts];
};
[[gnu::always_inline]] inline Value get_parts(const Block* blocks, std::ptrdiff_t slice) {
    return {{get(blocks[0], slice), get(blocks[1], slice), get(blocks[2], slice),
             get(blocks[3], slice)}};
}
[[gnu::always_inline]] inline void set_parts(Block* blocks, std::ptrdiff_t slice, const Value& v) {
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        set(blocks[p], slice, v.part[p]);
}
/// v += factor * x and v -= factor * x.
[[gnu::always_inline]] inline void add(Vector factor, const Value& x, Value& v) {
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        v.part[p] += factor * x.part[p];
}
[[gnu::always_inline]] inline void subtract(Vector factor, const Value& x, Value& v) {
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        v.part[p] -= factor * x.part[p];
}

} // namespace
} // namespace shearwake::spectral
