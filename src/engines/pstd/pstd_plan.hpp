// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/march.hpp"
#include "engines/pstd/scheme/stepper.hpp"

#include <vector>

namespace shearwake::pstd {

/// The decisions of the engine for a case: `run` executes them, and the resources follow from them.
struct PstdPlan {
    Grid grid;
    PmlOptions pml;
    double steps = 0.0;
    Absorption absorption = Absorption::none;
    Precision precision = Precision::double_precision;
    bool uneven = false;       // materials are given per node
    double coefficients = 0.0; // of the stepper, that are stored per node
    double source_nodes = 0.0; // of all ranks
    double output_B = 0.0;     // of a rank, while the stepper runs
};

/// Number of coefficients of a stepper that vary laterally with these properties.
double varying_coefficients(bool density, bool speeds, bool viscosity, Absorption absorption);

/// The work of the steps, without snapshots. Each step also adds to the displacements of the
/// columns of the domain, and each frame passes them on at all depths. Not collective.
engines::MarchWork march_work(const Case& c, const PstdPlan& plan);

/// The arrays of the rank with most planes. Not collective.
std::vector<engines::Array> arrays_of(const PstdPlan& plan, int ranks);

} // namespace shearwake::pstd
