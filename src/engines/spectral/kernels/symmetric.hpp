// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/parts.hpp"

namespace shearwake::spectral {

/// Products with eight dense symmetric matrices in parallel, one per lane, of which the lower
/// triangles are stored row by row.
struct SymmetricKernels {
    /// y = A x for the four parts, x[unknown][part]; y must not overlap x.
    void (*multiply)(std::ptrdiff_t unknowns, const Block* triangle, const Block* x, Block* y);
};

} // namespace shearwake::spectral
