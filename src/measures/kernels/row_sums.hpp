// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/block.hpp"

#include <cstddef>

namespace shearwake::measures {

/// Sums over the values of a row in eight partial sums: value i contributes to lane i % 8.
struct RowSums8 {
    Block u, abs_u, u2, u4; // sums of u, |u|, u^2, u^4
    Block peak;             // the largest |u|
};

/// Number of frames that add_lines() adds together.
constexpr std::size_t line_frames = 16;

struct RowSumKernels {
    /// Overwrites `sums` with those of `count` values.
    void (*row_sums)(const double* values, std::ptrdiff_t count, RowSums8& sums);
    /// Adds to row k of `sums` (lines x count) the sum over the first `used` rows of `frames`
    /// (line_frames x count) times their factors (lines x line_frames), one frame after the other,
    /// so that a value does not depend on which frames are added together. The number of lines is
    /// even, and the factors of the rows up to the next multiple of four are zero. `count` is a
    /// multiple of lane_count, and `frames` and `sums` are aligned as a Block.
    void (*add_lines)(const double* frames, std::ptrdiff_t used, std::ptrdiff_t count,
                      const double* factors, std::ptrdiff_t lines, double* sums);
};

} // namespace shearwake::measures
