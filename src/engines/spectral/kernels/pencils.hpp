// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/lines.hpp"

namespace shearwake::spectral {

/// The load at one time that contributes to a step, for the pencils of one ky.
struct LoadSample {
    const double* x;    // e^{-i kx x} for eight kx, complex
    double y_re, y_im;  // e^{-i ky y} times the amplitude
    const Block* shape; // spectrum of a changing pattern: re, im at +kx, re, im at -kx; or null
};

/// Operations of a step on arrays of pencils.
struct PencilKernels {
    /// before = 2 u - before + scale * change, for `count` blocks.
    void (*advance)(std::ptrdiff_t count, double scale, const Block* u, const Block* change,
                    Block* before);
    /// before = 2 u - before + scale * (change + more).
    void (*advance_by_sum)(std::ptrdiff_t count, double scale, const Block* u, const Block* change,
                           const Block* more, Block* before);
    /// to += scale * x.
    void (*add_scaled)(std::ptrdiff_t count, double scale, const Block* x, Block* to);
    /// to = scale * (a - b).
    void (*difference)(std::ptrdiff_t count, double scale, const Block* a, const Block* b,
                       Block* to);
    /// Sum of a * b over the unknowns, with weights `counted` for the parts.
    Block (*product)(std::ptrdiff_t count, const Block* a, const Block* b, const Block* counted);
    /// Sum of `count` samples times the spectrum of a constant pattern (null: each sample has its
    /// own).
    void (*put_load)(std::ptrdiff_t count, const LoadSample* samples, const Block* shape,
                     Block* surface);
};

} // namespace shearwake::spectral
