#pragma once

#include <cstddef>

namespace shearwake::neural {

/// Eight afferents side by side, one in each lane: every stage is written once, as for one of them,
/// and computes eight at a time. A vector type of g++ and clang.
constexpr std::size_t lane_count = 8;
using Lanes = double __attribute__((vector_size(8 * sizeof(double))));

/// The same value in every lane.
inline Lanes all_lanes(double value) {
    return Lanes{} + value;
}
/// max(v, 0) and max(-v, 0).
inline Lanes positive_part(Lanes v) {
    return v > 0.0 ? v : Lanes{};
}
inline Lanes negative_part(Lanes v) {
    return v < 0.0 ? -v : Lanes{};
}
inline Lanes magnitude(Lanes v) {
    return v < 0.0 ? -v : v;
}

} // namespace shearwake::neural
