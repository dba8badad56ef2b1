#pragma once

#include "engines/pstd/case_grid.hpp"
#include "engines/pstd/source.hpp"

namespace shearwake::pstd {

/// The load of a case, a moving sum of Gaussians, as what the stepper puts in; each sample costs
/// two exponentials for every row and column within six standard deviations of a focus.
///
/// Pressed (PstdLoad::traction), with nothing above the skin: s_zz = -p in the empty nodes, the
/// same in the first four of them and then fading out with the height. The stress must go on
/// smoothly across the skin: a force at the skin itself would also drive what moves without
/// straining the medium, and does not converge. With something above: the force p/d on u_z at z =
/// 0. Velocities get the load of the middle of their leap, and half of it at t = 0.
///
/// Moved (PstdLoad::displacement): u_z at z = 0 is set wherever a focus comes with more than a
/// thousandth of its peak within the run. The whole of it: k-Wave's Dirichlet source sets one of
/// three split parts, and the skin then moves several times as far.
Source load_source(const Case& c, const PstdOptions& options, const CaseGrid& grid, double step_s);

} // namespace shearwake::pstd
