#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/depth_mesh.hpp"

namespace shearwake {

/// The program itself, before any case.
constexpr double program_B = 40e6;

/// What varies laterally, by the bodies' bounds and a few samples of the map: no cell is looked at.
struct VariationEstimate {
    double points = 0.0; // of strain; each has `components` planes
    double components = 0.0;
    double cells = 0.0;         // where something is kept, all points together
    double fullest_cells = 0.0; // of the rank that has most
    double iterations = 0.0;    // a step
};
VariationEstimate estimate_variation(const Case& c, const DepthMesh& mesh, double step_s,
                                     int ranks);

/// Seconds are those of one core of a 2020s server, within a factor of three where it iterates;
/// the memory is counted, array by array.
Estimate estimate_spectral(const Case& c, const DepthMesh& mesh, std::ptrdiff_t steps_per_frame,
                           int ranks);

} // namespace shearwake
