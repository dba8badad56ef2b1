// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/lines.hpp"

namespace shearwake::spectral {

/// A depth at which the displacement is interpolated.
struct DisplacementDepth {
    std::ptrdiff_t first;  // first level of the element
    const double* weights; // of the element's nodes, for the interpolating polynomial
};

/// Depths, and the sizes of a pencil.
struct DisplacementArrays {
    std::ptrdiff_t nodes, levels; // nodes per element; moving levels
    std::ptrdiff_t depths;
    const DisplacementDepth* depth;
};

/// Transfers between pencils and lines of spectra of the displacement and the force along x, y and
/// z at some depths, [depth][component]; `stride` is the number of doubles between the lines of
/// consecutive planes. The two are adjoint.
struct DisplacementKernels {
    void (*displacement)(const DisplacementArrays& arrays, const WaveBlock& waves,
                         const Block* pencil, double* line, std::ptrdiff_t stride);
    /// Adds `scale` times the forces to a pencil.
    void (*add_force)(const DisplacementArrays& arrays, const WaveBlock& waves, const double* line,
                      std::ptrdiff_t stride, double scale, Block* pencil);
};

} // namespace shearwake::spectral
