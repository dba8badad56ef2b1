// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/bodies/lump_bodies.hpp"
#include "engines/spectral/spectral_estimate.hpp"

namespace shearwake::spectral::kinds {

/// Quantities from which the work of a case is computed.
struct Measures {
    const VariationEstimate& variation;
    double nodes = 0.0, levels = 0.0, steps = 0.0;
    double sponge_values = 0.0, sponge_every = 0.0; // 0: no sponge
    double felt = 0.0;                              // planes of receptor stress per frame
    double reactions = 0.0;                         // solves per step for forces of rigid bodies
    LumpSizes lumps;                                // rigid ones
    double near_pairs = 0.0;                        // lump_stress_pairs()
    double from_memory = 0.0; // share of the first solves of steps that is limited by memory
    double iterated_from_memory =
        0.0; // share of the solves of iterations that is limited by memory
};

/// Adds the work of the case to the estimate. Not collective.
void add_work(const Case& c, const Measures& measures, engines::Estimate& e);

/// One case for each kind of work, in which that kind dominates. Not collective.
std::vector<engines::Calibration> calibrations();

} // namespace shearwake::spectral::kinds
