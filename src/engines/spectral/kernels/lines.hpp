// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/parts.hpp"

namespace shearwake::spectral {

/// Eight consecutive wave vectors of a line over kx, and their mirror images at -kx.
struct WaveBlock {
    Block kx, k; // rad/m; k = |(kx, ky)|
    double ky;
    std::ptrdiff_t first; // index of the first kx; kx = 0 has index 0
    std::ptrdiff_t nx;    // complex numbers per line: kx = 0 ... nx/2 - 1 first, kx = -1 last
};

/// Transfers between blocks and complex lines of spectra over kx.
struct LineKernels {
    /// Write the four parts of the existing wave vectors to the line and read them; parts of wave
    /// vectors that do not exist are read as 0.
    void (*put)(const WaveBlock& waves, const Block* parts_of, double* line);
    void (*take)(const WaveBlock& waves, const double* line, Block* parts_of);
};

} // namespace shearwake::spectral
