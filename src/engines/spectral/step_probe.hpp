#pragma once

#include "engines/spectral/depth_mesh.hpp"

namespace shearwake {

/// The relative L2 error that a time step leaves in the surface field of the layers, without bodies
/// and maps: a few wave vectors of the case's load are stepped with it and with half of it, as long
/// as the run lasts. Their difference is 15/16 of the error where that is of fourth order and 3/4
/// where viscous forces make it one of second order. Takes milliseconds. Not collective.
double probed_error(const Case& c, const DepthMesh& mesh, double step_s);

} // namespace shearwake
