// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/block.hpp"

namespace shearwake::spectral {

// A pencil is the motion over depth of eight consecutive kx and their mirror images -kx, with one
// block per unknown and part. All of them share one real matrix.

/// The real and imaginary parts at +kx and at -kx.
constexpr std::ptrdiff_t parts = 4;
enum Part { plus_re, plus_im, minus_re, minus_im };

/// The lower triangle of a matrix, stored row by row from the first stored column to the diagonal.
/// Entry (row, column) has the index start + column.
struct SkylineRow {
    std::ptrdiff_t first; // first stored column
    std::ptrdiff_t start; // index that column 0 would have
};
/// The rows of a matrix.
struct SkylineRows {
    const SkylineRow* row;
    std::ptrdiff_t count;
};

/// Operations on eight matrices in parallel; each entry is a block.
struct SkylineKernels {
    /// Factorises L D L^T in place, separately for each lane. The diagonal then contains 1 / D.
    void (*factorise)(SkylineRows rows, Block* matrix);
    /// Solves A x = b in place for the four parts, x[unknown][part].
    void (*solve)(SkylineRows rows, const Block* factor, Block* x);
    /// x.A x for each lane, from the factor, with weights `counted` for the parts. Overwrites x.
    Block (*quadratic_form)(SkylineRows rows, const Block* factor, Block* x, const Block* counted);
};

} // namespace shearwake::spectral
