// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
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

/// Work, all-to-alls and memory of a stepper. Not collective.
engines::Estimate estimate_steps(const StepWork& work);

/// Output of displacements: one per frame, depth and point of the domain.
engines::Work work_of_frames(const Case& c);
/// Evaluation of the load and summation of its displacements for each column of the domain and
/// step.
engines::Work work_of_columns(const Case& c, double steps);
/// Summation of the displacements of volumes for each point and step.
engines::Work work_of_volumes(double points, double steps);

} // namespace shearwake::pstd
