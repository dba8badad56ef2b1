// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/block.hpp"

namespace shearwake::measures {

/// Sums over the values of a row in eight partial sums: value i contributes to lane i % 8.
struct RowSums8 {
    Block u, abs_u, u2, u4; // sums of u, |u|, u^2, u^4
    Block peak;             // the largest |u|
};

struct RowSumKernels {
    /// Overwrites `sums` with those of `count` values.
    void (*row_sums)(const double* values, std::ptrdiff_t count, RowSums8& sums);
};

} // namespace shearwake::measures
