#pragma once

#include "engines/pstd/case_grid.hpp"
#include "parallel/comm.hpp"

#include <string>
#include <vector>

namespace shearwake::pstd {

/// The extremes of a medium's properties on the grid.
struct Extremes {
    double p_modulus_Pa = 0.0, p_viscosity_Pa_s = 0.0; // lambda + 2 mu, chi + 2 eta
    double least_density_kg_m3 = 0.0;
    double alone_s = 0.0; // the smallest of the nodes' own largest steps
    void add(const NodeMaterial& material, double spacing_m);
};

/// Largest stable step of a uniform medium on cubic cells, K^2 = 3 (pi/d)^2, for P (c = c_p, E =
/// chi + 2 eta) and S (c = c_s, E = eta): dt^2 c^2 K^2 + 2 dt K^2 E/rho <= 4. Infinite where
/// nothing moves.
double largest_step_s(const NodeMaterial& material, double spacing_m);

/// The step that is stable whatever lies beside what: that rule with the stiffest modulus, the
/// largest viscosity and the least density of the grid, since the norm of a product is at most
/// the product of the norms.
double safe_step_s(const Extremes& extremes, double spacing_m);

/// Of the layers, fluid and bodies as given, before the grid is looked at.
Extremes extremes_of_layers(const Case& c, const PstdOptions& options);
/// Of all nodes. Collective.
Extremes extremes_of_grid(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                          const Comm& team);

/// The step that is taken, a whole number of times in a frame's interval.
struct StepChoice {
    double step_s = 0.0, safe_s = 0.0, alone_s = 0.0;
    std::ptrdiff_t per_frame = 1;
    bool refused = false; // the user's step is beyond what any of the media alone can have
};
StepChoice choose_step(const Case& c, const PstdOptions& options, const Extremes& extremes);
std::string refusal(const PstdOptions& options, const StepChoice& choice);

/// What is told of the choices, one line each.
std::vector<std::string> choice_notes(const Case& c, const PstdOptions& options,
                                      const StepChoice& step);

} // namespace shearwake::pstd
