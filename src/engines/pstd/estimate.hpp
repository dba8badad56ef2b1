// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/march.hpp"
#include "engines/pstd/scheme/stepper.hpp"

namespace shearwake::pstd {

/// Steps of the scheme on a grid that is distributed over `ranks` ranks.
struct StepWork {
    double points = 0.0, steps = 0.0;
    Absorption absorption = Absorption::none;
    Precision precision = Precision::double_precision;
    bool uneven = false; // materials are given per node
    int ranks = 1;
};

/// The work of the steps, without snapshots. Each step also adds to the displacements of the
/// columns of the domain, and each frame passes them on at all depths. Not collective.
engines::MarchWork march_work(const Case& c, const StepWork& work);

/// Memory of a rank with a stepper. Not collective.
double stepper_memory_B(const StepWork& work);

} // namespace shearwake::pstd
