// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/march.hpp"
#include "engines/pstd/scheme/stepper.hpp"

#include <vector>

namespace shearwake::pstd {

/// The decisions from which the resources of a run follow.
struct PstdPlan {
    double points = 0.0, steps = 0.0;
    Absorption absorption = Absorption::none;
    Precision precision = Precision::double_precision;
    bool uneven = false; // materials are given per node
};

/// The work of the steps, without snapshots. Each step also adds to the displacements of the
/// columns of the domain, and each frame passes them on at all depths. Not collective.
engines::MarchWork march_work(const Case& c, const PstdPlan& plan);

/// The arrays of a stepper on a rank. Not collective.
std::vector<engines::Array> arrays_of_stepper(const PstdPlan& plan, int ranks);

} // namespace shearwake::pstd
