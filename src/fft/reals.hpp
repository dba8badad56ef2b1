// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>

namespace shearwake::fft {

/// Complex numbers as their real and imaginary parts side by side, as the standard lays them out.
template <class Real>
Real* reals(std::complex<Real>* values) {
    return reinterpret_cast<Real*>(values);
}
template <class Real>
const Real* reals(const std::complex<Real>* values) {
    return reinterpret_cast<const Real*>(values);
}

} // namespace shearwake::fft
