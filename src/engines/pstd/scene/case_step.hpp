// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/pstd/scene/case_grid.hpp"
#include "parallel/comm.hpp"

#include <string>
#include <vector>

namespace shearwake::pstd {

/// Extreme values of the medium's properties on the grid.
struct Extremes {
    double p_modulus_Pa = 0.0, p_viscosity_Pa_s = 0.0; // lambda + 2 mu, chi + 2 eta
    double least_density_kg_m3 = 0.0;
    double alone_s = 0.0; // minimum over the nodes of the largest stable step of their material
    void add(const NodeMaterial& material, double spacing_m);
    /// Shear stiffness and density at the staggered points of a node.
    void add(double lambda_Pa, double mu_Pa, double density_kg_m3);
};

/// The spacing of cubic cells with the largest wave number of a grid. An odd number of points has
/// no wave of two points.
double cubic_spacing_m(const Grid& grid);

/// Largest stable step of a uniform medium on cubic cells, K^2 = 3 (pi/d)^2, for P (c = c_p, E =
/// chi + 2 eta) and S (c = c_s, E = eta): dt^2 c^2 K^2 + 2 dt K^2 E/rho <= 4. Infinite if no wave
/// exists.
double largest_step_s(const NodeMaterial& material, double spacing_m);

/// A step that is stable for any arrangement of the materials: the rule of largest_step_s() with
/// the largest modulus, the largest viscosity and the least density of the grid, because the norm
/// of a product is at most the product of the norms.
double safe_step_s(const Extremes& extremes, double spacing_m);

/// Extremes of all nodes, evaluated by this rank alone. Throws engines::StepNotChosen. Not
/// collective.
Extremes extremes_of_grid(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                          engines::ChoiceLimit limit = {});
/// The same extremes, with the rows of the grid divided among the ranks. Collective.
Extremes extremes_of_grid(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                          const Comm& team);

/// The chosen step; an integer number of steps makes one frame interval.
struct StepChoice {
    double step_s = 0.0, safe_s = 0.0, alone_s = 0.0;
    std::ptrdiff_t per_frame = 1;
    bool refused = false; // the specified step exceeds `alone_s`
};
/// Not collective.
StepChoice choose_step(const Case& c, const PstdOptions& options, const Extremes& extremes);
/// The message for a refused step.
std::string refusal(const PstdOptions& options, const StepChoice& choice);

/// The choices about the step, one line each. Not collective.
std::vector<engines::Choice> step_choices(const PstdOptions& options, const StepChoice& step);
/// The choices that follow from the case alone. Not collective.
std::vector<engines::Choice> case_choices(const Case& c, const PstdOptions& options);
/// All of these choices. Not collective.
std::vector<engines::Choice> choices(const Case& c, const PstdOptions& options,
                                     const StepChoice& step);

} // namespace shearwake::pstd
