// SPDX-License-Identifier: BSD-3-Clause
#include "fft/line_transform.hpp"

#include "fft/aligned.hpp"
#include "fft/wisdom.hpp"

namespace shearwake::fft {

// FFTW_ESTIMATE depends on the length alone, so that the same job always produces the same bits.
// Measured plans are not faster here for lengths 2^a 3^b 5^c 7^d.
LineTransform::LineTransform(std::ptrdiff_t length, Direction direction, std::ptrdiff_t lines)
    : length_(length) {
    AlignedVector<std::complex<double>> scratch(static_cast<std::size_t>(length * lines));
    auto* data = reinterpret_cast<fftw_complex*>(scratch.data());
    const int sign = direction == Direction::forward ? FFTW_FORWARD : FFTW_BACKWARD;
    const int n = static_cast<int>(length), count = static_cast<int>(lines);
    plan_estimated([&](unsigned flags) {
        plan_.reset(fftw_plan_many_dft(1, &n, count, data, nullptr, 1, n, data, nullptr, 1, n, sign,
                                       flags));
        return plan_ != nullptr;
    });
}

void LineTransform::execute(std::complex<double>* first_line) const {
    auto* data = reinterpret_cast<fftw_complex*>(first_line);
    fftw_execute_dft(plan_.get(), data, data);
}

std::string fftw_library_version() {
    return fftw_version;
}

CosineTransform::CosineTransform(std::ptrdiff_t half, std::ptrdiff_t lines) {
    AlignedVector<std::complex<double>> scratch(static_cast<std::size_t>((half + 1) * lines));
    auto* data = reinterpret_cast<double*>(scratch.data());
    // Real and imaginary parts are transformed separately: lines of stride 2.
    const int points = static_cast<int>(half + 1);
    const fftw_iodim64 along = {points, 2, 2};
    const fftw_iodim64 over[2] = {{lines, 2 * points, 2 * points}, {2, 1, 1}};
    const fftw_r2r_kind kind = FFTW_REDFT00;
    plan_estimated([&](unsigned flags) {
        plan_.reset(fftw_plan_guru64_r2r(1, &along, 2, over, data, data, &kind, flags));
        return plan_ != nullptr;
    });
}

void CosineTransform::execute(std::complex<double>* first_line) const {
    auto* data = reinterpret_cast<double*>(first_line);
    fftw_execute_r2r(plan_.get(), data, data);
}

} // namespace shearwake::fft
