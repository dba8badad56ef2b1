// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

#include <vector>

namespace shearwake {

/// The uplift of the skin that the images of the load beyond periodic edges cause. Tissue is nearly
/// incompressible: what a load displaces rises around it, at once and at all distances r beyond its
/// shear waves, by
///     u(r, t) = 1/(2 pi rho) (1/r^3) integral_0^t tau F(t - tau) dtau
/// on a half-space (the flow that starts from rest under the pressure of the load). On a plane this
/// happens mostly outside of the domain; a periodic domain keeps its volume, so that all of it
/// rises within. Returns the mean of the excess for each frame [m], upwards (against the direction
/// of u_z), for a load in the centre, on a layer of finite thickness as a sum over mirror images,
/// and from the moment at which P waves have crossed the domain. See docs/explanation/physics.md.
std::vector<double> image_uplift_m(const Case& c);

} // namespace shearwake
