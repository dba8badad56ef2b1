// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/depth/depth_mesh.hpp"

namespace shearwake::spectral {

/// Size of the laterally varying part of a case, estimated from the bounds of bodies and a few
/// samples of the map, without evaluating the cells.
struct VariationEstimate {
    double points = 0.0; // strain points; each has `components` planes
    double components = 0.0;
    double cells = 0.0;         // cells with data, sum over all points
    double fullest_cells = 0.0; // on the rank with most cells
    double iterations = 0.0;    // per step
};
/// Not collective.
VariationEstimate estimate_variation(const Case& c, const DepthMesh& mesh, double step_s,
                                     int ranks);

/// Resources of a case. The number of iterations is accurate within a factor of three; the memory
/// is counted array by array. Not collective.
engines::Estimate estimate_spectral(const Case& c, const DepthMesh& mesh,
                                    std::ptrdiff_t steps_per_frame, int ranks);

} // namespace shearwake::spectral
