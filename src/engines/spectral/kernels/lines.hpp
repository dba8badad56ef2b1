// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/skyline.hpp"

namespace shearwake::spectral {

/// A cosine and a sine of eight angles.
struct Turn {
    Block cosine, sine;
};

/// Parts of a folded line.
enum Fold { even_re, even_im, odd_re, odd_im, folds };
/// Number of doubles per fold of a line of nx points.
constexpr std::ptrdiff_t fold_pitch(std::ptrdiff_t nx) {
    return (nx / 2 + lane_count - 1) / lane_count * lane_count;
}

/// Eight consecutive wave vectors of a line over kx, and their mirror images at -kx.
struct WaveBlock {
    Block kx, k; // rad/m; k = |(kx, ky)|
    double ky;
    std::ptrdiff_t first; // index of the first kx; kx = 0 has index 0
    std::ptrdiff_t nx;    // complex numbers per line: kx = 0 ... nx/2 - 1 first, kx = -1 last
    /// Null if lines consist of complex numbers. Otherwise these are the angles of the middle m of
    /// a window, and lines are folded, [fold][kx] of fold_pitch(): with F' = F(kx) e^{i kx m},
    ///     even = F'(kx) + F'(-kx),   odd = F'(kx) - F'(-kx)
    /// of all kx >= 0 where they are written, and half of that where they are read.
    const Turn* middle = nullptr;
};

/// Symmetry of a quantity in wave space. What is imaginary is divided by i, and the values at -kx
/// of what is odd in kx change their sign, so that all quantities are real and even.
struct Symmetry {
    bool imaginary = false, odd = false;
};

/// Transfers between blocks and lines of spectra over kx.
struct LineKernels {
    /// Write the four parts of the existing wave vectors to the line and read them; parts of wave
    /// vectors that do not exist are read as 0.
    void (*put)(const WaveBlock& waves, Symmetry symmetry, const Block* parts_of, double* line);
    void (*gather)(const WaveBlock& waves, Symmetry symmetry, const double* line, Block* parts_of);
};

} // namespace shearwake::spectral
