// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"

namespace shearwake::pstd {

/// Runs a case whose PstdOptions refer to a grid study: grid, absorbing layer, medium and sources
/// are those of the study. Frames contain the displacement at the points of the domain and the
/// measured depths (node k of z is at k d, u_z half a cell below). The series of the sensor are
/// part of the report in `solved`. Throws CaseFailure on all ranks together if the domain or times
/// of the case do not match the study. Collective.
void run_study(const Case& c, const Comm& team, engines::Observer& observer,
               engines::Checkpoints* checkpoints);

/// Resources of a grid study. Not collective.
engines::Estimate estimate_study(const Case& c, int ranks);

} // namespace shearwake::pstd
