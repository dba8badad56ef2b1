// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

#include <vector>

namespace shearwake {

/// The lateral sponge is a drag gamma on the velocity, which increases from 0 at distance W (its
/// width) from the edge up to the edge. Beyond the periodic edge follows the sponge of the opposite
/// side, so that a leaving wave crosses 2 W. Both the reflected and the transmitted energy return.
/// For waves of speed c in one dimension,
///     gamma(d) = 7.3 c/W (1 - d/W)^{3/2}
/// transmits 0.3 % of the energy of a short wave. In total, 0.45 % returns at a wavelength of W,
/// 0.7 % at 1.5 W, 1 % at 1.65 W, 2 % at 2 W and 7 % at 3 W. A smaller drag transmits more of short
/// waves, and a larger or steeper drag reflects more of long ones.
double edge_drag_Hz(double distance_m, double width_m, double speed_m_s);

/// The fraction of the energy of a plane wave at normal incidence that returns, according to that
/// formula. For a pulse of a focus in three dimensions, whose waves leave at all angles, the
/// measured fraction is 1 to 3 times that of its longest wave (tests/verify/test_spectral_edges).
double returned_energy(double wavelength_m, double width_m);

/// The design speed of sponges: that of the mean shear modulus and density of the uppermost
/// `depth_m`, since a surface wave penetrates to about its wavelength.
double edge_speed_m_s(const Medium& medium, double depth_m);

/// The wavelength that edges must absorb, at a shear wave speed: the larger of that of the
/// modulation and three times that at which the spectrum of the footprint has fallen to a half.
double longest_wave_m(const Load& load, double speed_m_s);

/// The uplift of the skin that the images of the load beyond periodic edges cause. On a plane,
/// tissue rises beyond the shear waves of a load and sinks within; a periodic domain keeps its
/// volume. Returns the difference of the means over the domain for each frame [m], upwards (against
/// the direction of u_z), for a load in the centre, from the modes of a homogeneous nearly
/// incompressible layer with the mean modulus of the medium, as damped oscillators, from the moment
/// at which P waves have crossed the domain. See docs/explanation/physics.md.
std::vector<double> image_uplift_m(const Case& c);

} // namespace shearwake
