// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/skyline.hpp"

namespace shearwake::spectral {

/// Eight symmetric matrices, one per lane: the lower triangles row by row, [entry][lane]. The sum
/// of both parts has 49 significant bits, `high` alone has 24.
struct SymmetricArrays {
    const float *high, *low;
};

/// Products with eight dense symmetric matrices in parallel.
struct SymmetricKernels {
    using Multiply = void (*)(std::ptrdiff_t unknowns, const SymmetricArrays& matrix,
                              const Block* x, Block* y);
    /// y = A x for the four parts, x[unknown][part]; y must not overlap x. The rounded product uses
    /// `high` alone, which halves the memory traffic.
    Multiply multiply, multiply_rounded;
};

} // namespace shearwake::spectral
