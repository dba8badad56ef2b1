#pragma once

#include "engines/spectral/depth_mesh.hpp"
#include "engines/spectral/time_step.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// How time and depth are divided, one line each.
std::vector<std::string> discretisation_notes(const TimeStep& time, const DepthMesh& mesh);

/// What the edges give back.
std::vector<std::string> edge_notes(const Case& c);

/// What bodies and the map will make the engine do, as far as their properties tell without the
/// grid: stiffnesses beyond the cap, and what needs iterations.
std::vector<std::string> variation_notes(const Case& c, const SpectralOptions& options);

} // namespace shearwake
