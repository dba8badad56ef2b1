// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/block.hpp"

namespace shearwake::spectral {

// A pencil is the motion over depth of eight consecutive kx and their mirror images -kx, with one
// block per unknown and part. All of them share one real matrix.

/// The real and imaginary parts at +kx and at -kx.
constexpr std::ptrdiff_t parts = 4;
enum Part { plus_re, plus_im, minus_re, minus_im };

} // namespace shearwake::spectral
