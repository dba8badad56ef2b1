// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/medium/medium.hpp"

#include <cmath>
#include <complex>

namespace shearwake::test {

/// W/p [m/Pa] of a homogeneous half-space in closed form: -alpha k_s^2 / (mu R) with the Rayleigh
/// function R = (2k^2 - k_s^2)^2 - 4 k^2 alpha beta, written without cancellation for k >> k_s.
inline std::complex<double> half_space_response(const Layer& layer,
                                                std::complex<double> omega_rad_s, double k) {
    const std::complex<double> mu = shear_modulus(layer, omega_rad_s);
    const std::complex<double> m = p_wave_modulus(layer, omega_rad_s);
    const std::complex<double> inertia = layer.density_kg_m3 * omega_rad_s * omega_rad_s;
    const std::complex<double> kp2 = inertia / m, ks2 = inertia / mu, ratio = mu / m;
    const double k2 = k * k;
    const std::complex<double> alpha = std::sqrt(k2 - kp2), beta = std::sqrt(k2 - ks2);
    // R / k_s^2 = -4 k^2 + k_s^2 + 4 k^2 (k^2 - alpha beta) / k_s^2, and
    // (k^2 - alpha beta) / k_s^2 = (k^2 (1 + ratio) - k_p^2) / (k^2 + alpha beta).
    const std::complex<double> reduced =
        -4.0 * k2 + ks2 + 4.0 * k2 * (k2 * (1.0 + ratio) - kp2) / (k2 + alpha * beta);
    return -alpha / (mu * reduced);
}

} // namespace shearwake::test
