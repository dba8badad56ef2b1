#pragma once

#include <cstddef>

namespace shearwake {

/// Eight doubles side by side: what is written once, as for one of them, is computed for eight at a
/// time, in one vector instruction or a few of a narrower machine. Types of g++ and clang.
constexpr std::ptrdiff_t lane_count = 8;
/// Anywhere in memory: loads need no alignment beyond a double's.
using Lanes = double __attribute__((vector_size(8 * sizeof(double)), aligned(8), may_alias));
/// In containers, whose template arguments would lose the attributes of the other.
using AlignedLanes = double __attribute__((vector_size(8 * sizeof(double))));

inline Lanes* lanes(double* values) {
    return reinterpret_cast<Lanes*>(values);
}
inline const Lanes* lanes(const double* values) {
    return reinterpret_cast<const Lanes*>(values);
}

/// The same value in every lane.
inline AlignedLanes all_lanes(double value) {
    return AlignedLanes{} + value;
}
/// max(v, 0) and max(-v, 0).
inline AlignedLanes positive_part(AlignedLanes v) {
    return v > 0.0 ? v : AlignedLanes{};
}
inline AlignedLanes negative_part(AlignedLanes v) {
    return v < 0.0 ? -v : AlignedLanes{};
}
inline AlignedLanes magnitude(AlignedLanes v) {
    return v < 0.0 ? -v : v;
}

inline double sum_of(Lanes v) {
    return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}

} // namespace shearwake
