// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/skyline.hpp"

#include <vector>

namespace shearwake::spectral {

/// Structure of symmetric positive definite matrices of a chain of spectral elements, for eight
/// wavenumbers in parallel. An unknown couples only to those of its own elements, and the fill-in
/// of L D L^T stays there. Each row of the lower triangle is stored from the first unknown of its
/// element to the diagonal, which takes half of the memory of a band. The computations are in
/// SkylineKernels.
class SkylineMatrix {
public:
    /// Structure for elements of `degree` with `per_level` unknowns at each of the first `levels`
    /// levels.
    SkylineMatrix(std::ptrdiff_t levels, std::ptrdiff_t degree, std::ptrdiff_t per_level);

    std::ptrdiff_t entries() const { return entries_; } // per matrix
    /// Valid for the lifetime of this object.
    SkylineRows rows() const { return {rows_.data(), static_cast<std::ptrdiff_t>(rows_.size())}; }

private:
    std::vector<SkylineRow> rows_;
    std::ptrdiff_t entries_ = 0;
};

} // namespace shearwake::spectral
