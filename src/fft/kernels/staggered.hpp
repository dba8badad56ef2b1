// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace shearwake::fft {

/// Bytes of a row of a block: two lines of the cache.
constexpr std::ptrdiff_t row_bytes = 128;

/// What StaggeredDerivative computes and moves besides its transforms. Pitches are counted in
/// reals; a row of a block has row_bytes / sizeof(Real) of them.
template <class Real>
struct StaggeredKernels {
    /// spectra[l][m] *= f[m] for complex lines of `points` numbers (re, im, re, im ...), f as
    /// `real` (re f, re f, ...) and `imaginary` (-im f, im f, ...).
    void (*multiply)(Real* spectra, const Real* real, const Real* imaginary, std::ptrdiff_t points,
                     std::ptrdiff_t lines);
    /// A complex line from its real and its imaginary part, and back.
    void (*join)(const Real* re, const Real* im, std::ptrdiff_t points, Real* line);
    void (*part)(const Real* line, std::ptrdiff_t points, Real* re, Real* im);
    /// Copies `rows` whole rows of a block. `stream_rows` does not read what it overwrites into the
    /// cache, for what is not needed soon; `to` is then aligned to lines of the cache.
    void (*copy_rows)(const Real* from, std::ptrdiff_t from_pitch, std::ptrdiff_t rows, Real* to,
                      std::ptrdiff_t to_pitch);
    void (*stream_rows)(const Real* from, std::ptrdiff_t from_pitch, std::ptrdiff_t rows, Real* to,
                        std::ptrdiff_t to_pitch);
};

} // namespace shearwake::fft
