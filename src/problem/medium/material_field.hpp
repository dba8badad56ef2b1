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

/// The material of a cell. Where the surface of a body crosses it, shear across the surface meets
/// other moduli than shear along it, those of Material.
struct CellMaterial : Material {
    double mu_across_Pa = 0.0, viscosity_across_Pa_s = 0.0;
    Vec3 normal{}; // of the surface, of length 1; 0 in uniform cells
    bool is_laminate() const { return norm(normal) > 0.0; }
};

/// The material of a cell in layer number `layer`: that of the layer, replaced by values of the
/// map, then combined with each body in turn, which fills the fraction f. The map applies at the
/// centre of the cell. If its points are at most 1.5 cells apart and their shear modulus or
/// viscosity changes within the cell by more than a factor of 1.2, the cell is a laminate, as
/// below, of these points, weighted as 4 x 4 x 4 interpolations weight them, with the gradient of
/// the modulus as its normal. It counts as stiffer if any of its points is stiffer than the layer.
/// Properties that a body does not give are those of the layer and the map. In a cell of size 0, f
/// is the share of the body within its smooth edge, and all properties are means (1 - f) m + f
/// m_body. Otherwise the cell is a laminate, with the mean <x> = (1 - f) x + f x_body and M =
/// lambda
/// + 2 mu (Backus 1962):
///
/// - density <density>; lambda <lambda / M> / <1 / M>;
/// - mu across the surface 1 / <1 / mu>; the other moduli of the laminate differ by parts of mu /
/// M;
/// - mu along the surface <mu> for a body that is softer. The surface of a stiff body hardly
///   stretches, but the medium in front of it does within the size of a cell, so that <mu> would
///   enlarge the body (by a third of a cell if it is 400 times stiffer). mu is the self-consistent
///   estimate for an incompressible mixture of grains (Hill 1965; Budiansky 1965), which for high
///   contrasts is stiff only if the body fills more than two fifths of the cell;
/// - viscosity (mu(s) - mu(0)) / s with mu + s viscosity for mu of each part, where s is the growth
///   at which the largest viscous part is a quarter of the modulus, since no viscosity is exact for
///   all frequencies; along the surface of a body that is softer or not more viscous <viscosity>.
CellMaterial material_of_cell(const Medium& medium, std::size_t layer, Vec3 centre_m, Vec3 size_m);

/// Whether bodies or the map may be present between two depths. Fast, since only bounds are
/// compared.
bool varies_between(const Medium& medium, double top_m, double bottom_m);

} // namespace shearwake
