// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/volume.hpp"

#include <vector>

namespace shearwake::pipeline {

/// What a vibrometer records.
struct Scan {
    std::vector<double> time_s;       // from the trigger
    std::vector<double> velocity_m_s; // one row of times per point; NaN: no signal
    std::vector<double> quality; // of each point: power of the signal divided by that of signal
                                 // and noise; 0: no signal
};

/// The velocity that the vibrometer of a case records for these displacements along its line of
/// sight (one row of frames per point). The displacement is interpolated by polynomials of degree 5
/// through six frames, at rest before t = 0 or periodic, and differentiated; filters, noise and
/// missing points follow. The noise of a point depends on the seed and its number alone.
Scan scan(const Case& c, const std::vector<double>& displacements_m);

/// The group /vibrometer of the case file.
VariableGroup vibrometer_group(const Case& c, const std::vector<double>& displacements_m);

} // namespace shearwake::pipeline
