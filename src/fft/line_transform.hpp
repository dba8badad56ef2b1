// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/fftw_real.hpp"

#include <complex>
#include <string>

namespace shearwake::fft {

/// Sign of the exponent: forward is -, backward is +.
enum class Direction { forward, backward };

/// In-place unnormalised complex transform of `lines` consecutive contiguous lines of `length`
/// points: forward is sum_n x_n e^{-2 pi i m n / N}, backward has the opposite sign. Sixteen lines
/// of 560 points in one call take 0.8 of the time of sixteen calls. Not collective.
class LineTransform {
public:
    LineTransform(std::ptrdiff_t length, Direction direction, std::ptrdiff_t lines = 1);
    /// Transforms all lines. `first_line` holds lines * length values and is aligned as
    /// AlignedVector.
    void execute(std::complex<double>* first_line) const;
    std::ptrdiff_t length() const { return length_; }

private:
    FftwPlan plan_;
    std::ptrdiff_t length_;
};

/// Version of the linked library, for example "fftw-3.3.10-...".
std::string fftw_library_version();

/// In-place cosine transform of `lines` consecutive contiguous lines of `half` + 1 complex numbers,
/// the first half of an even sequence of period N = 2 half:
///     X_m = x_0 + (-1)^m x_half + 2 sum_{n=1}^{half-1} x_n cos(2 pi m n / N),
/// which is the Fourier transform of the sequence at m = 0 ... half. Planned with FFTW_ESTIMATE, so
/// that the same transform always produces the same bits. Not collective.
class CosineTransform {
public:
    CosineTransform(std::ptrdiff_t half, std::ptrdiff_t lines);
    /// `first_line` is aligned as AlignedVector.
    void execute(std::complex<double>* first_line) const;

private:
    FftwPlan plan_;
};

} // namespace shearwake::fft
