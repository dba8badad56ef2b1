// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/depth_mesh.hpp"

namespace shearwake::spectral {

/// Relative L2 error of the surface field that a time step causes in the layers, without bodies and
/// maps. A few wave vectors of the case's load are advanced with this step and with half of it for
/// the duration of the run. Their difference is 15/16 of an error of fourth order, and 3/4 of one
/// of second order (viscous forces). A run of more than 2500 frames is extrapolated from its first
/// 2500. Takes milliseconds. Not collective.
double probed_error(const Case& c, const DepthMesh& mesh, double step_s);

/// Relative L2 error of the surface field that the absorber of a half-space causes: the difference
/// from an absorber of twice the depth at the lowest wave vectors of the domain, relative to the
/// field of the load. Advances twelve pencils for the duration of the run, at most 2500 frames. Not
/// collective.
double probed_return(const Case& c, const SpectralOptions& options, double step_s);

} // namespace shearwake::spectral
