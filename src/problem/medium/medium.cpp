// SPDX-License-Identifier: BSD-3-Clause
#include "problem/medium/medium.hpp"

#include "base/error.hpp"

#include <cmath>

namespace shearwake {

using Complex = std::complex<double>;

bool operator==(const Medium& a, const Medium& b) {
    const bool same_map = a.map && b.map ? *a.map == *b.map : a.map == b.map;
    return a.layers == b.layers && a.base == b.base && a.bodies == b.bodies && same_map;
}

std::optional<double> newtonian_viscosity_Pa_s(const ShearLoss& loss) {
    using Viscosity = std::optional<double>;
    return std::visit(
        overloaded{[](const Lossless&) -> Viscosity { return 0.0; },
                   [](const KelvinVoigt& law) -> Viscosity { return law.viscosity_Pa_s; },
                   [](const FractionalKelvinVoigt&) -> Viscosity { return {}; },
                   [](const StandardLinearSolid&) -> Viscosity { return {}; }},
        loss);
}

double static_shear_modulus(const Layer& layer) {
    return layer.density_kg_m3 * layer.c_s_m_s * layer.c_s_m_s;
}

Complex shear_modulus(const Layer& layer, Complex omega_rad_s) {
    const double mu0 = static_shear_modulus(layer);
    const Complex s = Complex(0.0, 1.0) * omega_rad_s; // i omega
    return std::visit(
        overloaded{
            [&](const Lossless&) -> Complex { return mu0; },
            [&](const KelvinVoigt& law) -> Complex { return mu0 + s * law.viscosity_Pa_s; },
            [&](const FractionalKelvinVoigt& law) -> Complex {
                return mu0 * (1.0 + std::pow(s * law.tau_s, law.exponent));
            },
            [&](const StandardLinearSolid& law) -> Complex {
                return mu0 * (1.0 + law.strength * s * law.tau_s / (1.0 + s * law.tau_s));
            },
        },
        layer.loss);
}

Complex p_wave_modulus(const Layer& layer, Complex omega_rad_s) {
    const double lambda =
        layer.density_kg_m3 * layer.c_p_m_s * layer.c_p_m_s - 2.0 * static_shear_modulus(layer);
    return lambda + 2.0 * shear_modulus(layer, omega_rad_s);
}

double rayleigh_speed_m_s(const Layer& layer) {
    // With s = (c/c_s)^2: (2 - s)^2 = 4 sqrt(1 - s) sqrt(1 - s c_s^2/c_p^2); s = 0 is a trivial
    // root; the Rayleigh root lies in (0, 1), where the left side minus the right side changes
    // sign.
    const double ratio = std::pow(layer.c_s_m_s / layer.c_p_m_s, 2);
    const auto f = [&](double s) {
        return std::pow(2.0 - s, 2) - 4.0 * std::sqrt((1.0 - s) * (1.0 - s * ratio));
    };
    double low = 0.1, high = 1.0;
    if (!(f(low) < 0.0 && f(high) > 0.0)) throw Error("no Rayleigh wave for this layer");
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (f(middle) < 0.0 ? low : high) = middle;
    }
    return layer.c_s_m_s * std::sqrt(0.5 * (low + high));
}

const Layer& surface_wave_layer(const Medium& medium, double width_m) {
    for (const Layer& layer : medium.layers)
        if (layer.thickness_m > 0.25 * width_m) return layer;
    return medium.layers.back();
}

bool varies_laterally(const Medium& medium) {
    return !medium.bodies.empty() || medium.map;
}

} // namespace shearwake
