// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/medium/medium.hpp"

#include <cstddef>

namespace shearwake {

struct Speeds {
    double c_p_m_s = 0.0;
    double c_s_m_s = 0.0;
    bool operator==(const Speeds&) const = default;
};

/// c_p / c_s above which lambda + 2/3 mu > 0. Otherwise, the material would expand under
/// hydrostatic pressure.
constexpr double least_speed_ratio = 1.1547005383792515; // 2 / sqrt 3
bool has_positive_bulk_modulus(const Speeds& speeds);

/// The speeds with the smallest c_p / c_s within layer number `layer`, including the map; with
/// `body`, within the part of the layer that the body occupies. The ratio is not smaller between
/// the points of a map.
Speeds softest_against_pressure(const Medium& medium, std::size_t layer,
                                const Body* body = nullptr);

/// Top and bottom of the layer; the bottom of a half-space is at infinity.
DepthRange depths(const Medium& medium, std::size_t layer);

/// Coefficients for engines with lateral variation: sigma = lambda div u + 2 mu strain, with mu
/// replaced by mu + viscosity d/dt.
struct Material {
    double density_kg_m3 = 0.0;
    double lambda_Pa = 0.0;
    double mu_Pa = 0.0;
    double viscosity_Pa_s = 0.0;
    bool operator==(const Material&) const = default;
};

/// lambda = rho (c_p^2 - 2 c_s^2) and mu = rho c_s^2. The viscosity is that of Kelvin-Voigt, and 0
/// for lossless layers and for the other laws, which engines reject beforehand.
Material material_of(const Layer& layer);

/// The material of a cell in layer number `layer`: that of the layer, replaced by values of the map
/// at the centre of the cell, then mixed with each body in turn according to the fraction f that it
/// fills: (1 - f) m + f m_body for density, lambda, mu and viscosity. Properties that a body does
/// not give are those of the layer and the map.
Material material_of_cell(const Medium& medium, std::size_t layer, Vec3 centre_m, Vec3 size_m);

/// Whether bodies or the map may be present between two depths. Fast, since only bounds are
/// compared.
bool varies_between(const Medium& medium, double top_m, double bottom_m);

} // namespace shearwake
