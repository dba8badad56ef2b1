// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/edge_absorption.hpp"

#include "base/constants.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace shearwake {
namespace {

constexpr double damping_scale = 7.3;

} // namespace

double edge_drag_Hz(double distance_m, double width_m, double speed_m_s) {
    const double inward = distance_m / width_m;
    if (!(inward < 1.0)) return 0.0;
    return damping_scale * speed_m_s / width_m * std::pow(1.0 - std::max(inward, 0.0), 1.5);
}

/// Solves u'' + (k^2 - i k gamma/c) u = 0 slice by slice from the far side, where u = e^{-ikx}.
double returned_energy(double wavelength_m, double width_m) {
    using Complex = std::complex<double>;
    constexpr Complex i(0.0, 1.0);
    constexpr int slices = 240;
    const double k = two_pi * width_m / wavelength_m, thickness = 2.0 / slices;
    Complex u = 1.0, slope = -i * k;
    for (int n = 0; n < slices; ++n) {
        const double from_edge = std::abs(1.0 - (n + 0.5) * thickness);
        const Complex q = std::sqrt(k * k - i * k * edge_drag_Hz(from_edge, 1.0, 1.0));
        const Complex c = std::cos(q * thickness), s = std::sin(q * thickness), was = u;
        u = c * was - s / q * slope;
        slope = q * s * was + c * slope;
    }
    const Complex in = 0.5 * (u + i * slope / k), back = 0.5 * (u - i * slope / k);
    return (std::norm(back) + 1.0) / std::norm(in);
}

double edge_speed_m_s(const Medium& medium, double depth_m) {
    double mass = 0.0, stiffness = 0.0, top_m = 0.0;
    for (std::size_t l = 0; l < medium.layers.size(); ++l) {
        const Layer& layer = medium.layers[l];
        const bool endless = medium.base == Base::half_space && l + 1 == medium.layers.size();
        const double bottom_m = endless ? depth_m : std::min(depth_m, top_m + layer.thickness_m);
        const double thickness_m = std::max(bottom_m - top_m, 0.0);
        mass += layer.density_kg_m3 * thickness_m;
        stiffness += static_shear_modulus(layer) * thickness_m;
        top_m += thickness_m;
    }
    return mass > 0.0 ? std::sqrt(stiffness / mass) : 0.0;
}

double longest_wave_m(const Load& load, double speed_m_s) {
    const double of_footprint_m = 3.0 * two_pi / bandwidth_rad_m(load.footprint, 0.5);
    const auto frequency_Hz = modulation_frequency_Hz(load.modulation);
    if (!frequency_Hz || !(*frequency_Hz > 0.0)) return of_footprint_m;
    return std::max(of_footprint_m, speed_m_s / *frequency_Hz);
}

} // namespace shearwake
