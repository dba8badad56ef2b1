// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/fftw_plan.hpp"

#include <complex>

namespace shearwake::fft {

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
