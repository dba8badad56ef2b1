#pragma once

#include "model/case.hpp"

namespace shearwake {

/// The lateral sponge, a drag gamma on the velocity, grows from nothing at distance W (its width)
/// from the edge to the edge itself. Beyond the periodic edge lies the sponge of the other side, so
/// that a leaving wave meets 2 W: it returns what is reflected and what passes through. For waves
/// of speed c in one dimension,
///     gamma(d) = 7.3 c/W (1 - d/W)^{3/2}
/// passes 0.3 % of a short wave's energy and returns, both together, 0.45 % at a wavelength of W,
/// 0.7 % at 1.5 W, 1 % at 1.65 W, 2 % at 2 W and 7 % at 3 W: less drag passes more of the short
/// waves, more drag (or a steeper one) reflects more of the long ones.
double edge_drag_Hz(double distance_m, double width_m, double speed_m_s);

/// The share of a plane wave's energy that comes back, leaving straight through the edge, by that
/// formula. Of a pulse of a focus in three dimensions, whose waves leave at all angles, 1 to 3
/// times that of its longest wave was seen (tests/verify/test_spectral_edges).
double returned_energy(double wavelength_m, double width_m);

/// The speed that sponges are made for: of the mean shear modulus and density of the uppermost
/// `depth_m`, since a surface wave feels as deep as it is long.
double edge_speed_m_s(const Medium& medium, double depth_m);

/// The wavelength that edges must absorb, at a shear wave speed: that of the modulation or, longer
/// or not, three times the one at which the footprint's spectrum has fallen to a half.
double longest_wave_m(const Load& load, double speed_m_s);

} // namespace shearwake
