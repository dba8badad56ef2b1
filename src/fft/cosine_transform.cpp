// SPDX-License-Identifier: BSD-3-Clause
#include "fft/cosine_transform.hpp"

#include "fft/aligned.hpp"
#include "fft/wisdom.hpp"

namespace shearwake::fft {

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
