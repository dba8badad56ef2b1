#pragma once

#include "fft/fftw_plan.hpp"

#include <complex>
#include <string>

namespace shearwake {

enum class Direction { forward, backward };

/// In-place complex transform of one contiguous aligned line, unnormalised:
/// forward sum x_n e^{-2 pi i m n / N}, backward with +. Not collective.
class LineTransform {
public:
    LineTransform(std::ptrdiff_t length, Direction direction);
    void execute(std::complex<double>* line) const;
    std::ptrdiff_t length() const { return length_; }

private:
    FftwPlan plan_;
    std::ptrdiff_t length_;
};

/// "fftw-3.3.10-..." of the library that is linked.
std::string fftw_library_version();

} // namespace shearwake
