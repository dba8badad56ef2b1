// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "problem/medium/body.hpp"
#include "problem/medium/material_map.hpp"

#include <complex>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace shearwake {

/// Shear-loss laws mu(omega) with mu0 = rho c_s^2, for the time convention e^{+i omega t}.
struct Lossless {
    static constexpr const char* name = "none";
    bool operator==(const Lossless&) const = default;
};
/// mu0 + i omega viscosity.
struct KelvinVoigt {
    static constexpr const char* name = "kelvin-voigt";
    double viscosity_Pa_s = 0.0;
    bool operator==(const KelvinVoigt&) const = default;
};
/// mu0 (1 + (i omega tau)^exponent), 0 < exponent < 1: a spring in parallel with a "spring-pot".
struct FractionalKelvinVoigt {
    static constexpr const char* name = "fractional";
    double tau_s = 0.0;
    double exponent = 0.5;
    bool operator==(const FractionalKelvinVoigt&) const = default;
};
/// mu0 (1 + strength i omega tau / (1 + i omega tau)): relaxed modulus mu0, unrelaxed
/// mu0 (1 + strength).
struct StandardLinearSolid {
    static constexpr const char* name = "standard-linear";
    double tau_s = 0.0;
    double strength = 0.0;
    bool operator==(const StandardLinearSolid&) const = default;
};
using ShearLoss = std::variant<Lossless, KelvinVoigt, FractionalKelvinVoigt, StandardLinearSolid>;

/// One homogeneous layer. The last layer over a half-space has no thickness (0).
struct Layer {
    std::string name;
    double thickness_m = 0.0;
    double density_kg_m3 = 0.0;
    double c_p_m_s = 0.0;
    double c_s_m_s = 0.0;
    ShearLoss loss = Lossless{};
    bool operator==(const Layer&) const = default;
};

enum class Base { rigid, half_space };
constexpr auto names_of(std::type_identity<Base>) {
    return std::array{"rigid", "half-space"};
}

/// Layers from the surface z = 0 downward, on a rigid base or ending in a half-space, and their
/// inclusions: first a map, then bodies, each of which replaces the material before it
/// (problem/medium/material_field.hpp).
struct Medium {
    std::vector<Layer> layers;
    Base base = Base::rigid;
    std::vector<Body> bodies;
    std::shared_ptr<const MaterialMap> map; // shared by the cases of a sweep, since it may be large

    /// Maps are compared by their content.
    friend bool operator==(const Medium& a, const Medium& b);
};

/// mu(omega) [Pa]; omega [rad/s] may be complex with Im omega <= 0.
std::complex<double> shear_modulus(const Layer& layer, std::complex<double> omega_rad_s);

/// The viscosity in mu = mu0 + i omega viscosity, 0 without losses; none of other laws [Pa s].
std::optional<double> newtonian_viscosity_Pa_s(const ShearLoss& loss);

/// Re mu at omega = 0 [Pa].
double static_shear_modulus(const Layer& layer);

/// lambda + 2 mu with lambda of the lossless layer, which does not depend on viscosity [Pa].
std::complex<double> p_wave_modulus(const Layer& layer, std::complex<double> omega_rad_s);

/// Speed of the Rayleigh wave over a lossless half-space of this layer [m/s]: the root of the
/// Rayleigh equation below c_s. Throws Error when there is none.
double rayleigh_speed_m_s(const Layer& layer);

/// The layer that determines surface waves under a footprint of that width: the first one thicker
/// than a quarter of the width, or the last. A thinner film follows the layer below.
const Layer& surface_wave_layer(const Medium& medium, double width_m);

/// Whether bodies or a map make the medium vary along x and y.
bool varies_laterally(const Medium& medium);

} // namespace shearwake
