#pragma once

#include "engines/engine.hpp"

namespace shearwake::pstd {

/// Runs a case whose PstdOptions name a study: grid, layer, medium and sources are the study's,
/// frames show the displacement of the domain's points at the measured depths (node k of z stands
/// at k d, u_z half a cell below), and what its sensor hears is told with `solved`. Collective;
/// throws CaseFailure on all ranks together when domain or times of the case do not fit the study.
void run_study(const Case& c, const Comm& team, Observer& observer, Checkpoints* checkpoints);

Estimate estimate_study(const Case& c, int ranks);

} // namespace shearwake::pstd
