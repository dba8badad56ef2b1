// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/stepping/time_step.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::spectral {

/// Notes on the discretisation in time and depth, with the errors if they have been estimated, one
/// line each. Not collective.
std::vector<std::string> discretisation_notes(const TimeStep& time, const DepthMesh& mesh,
                                              const std::optional<ProbedErrors>& errors);

/// A warning if the estimated error exceeds the accuracy of the options. Not collective.
std::vector<Remark> accuracy_warnings(const Case& c, const ProbedErrors& errors);

/// Notes on the share of energy that the absorbing edges return, one line each. Not collective.
std::vector<std::string> edge_notes(const Case& c);

/// How each body is treated: as rigid because the case or the engine says so, or as elastic, and
/// why a stiff one is elastic; one line each. Not collective.
std::vector<std::string> body_notes(const Case& given);

/// Choices about elastic bodies and the map, as far as it follows from the case without
/// the grid: shear stiffnesses above the cap, and properties that require an iterative solve. Not
/// collective.
std::vector<engines::Choice> variation_choices(const Case& c, const SpectralOptions& options);

} // namespace shearwake::spectral
