// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scene/case_grid.hpp"
#include "engines/pstd/scheme/source.hpp"

namespace shearwake::pstd {

/// The load of a case, a moving sum of Gaussians, as a source of the stepper. A sample costs two
/// exponentials for every row and column within six standard deviations of a focus.
///
/// PstdLoad::traction with nothing above the skin: s_zz = -p in the empty nodes, constant in the
/// first four of them and then decreasing to 0 with height. The stress must be continued smoothly
/// across the skin: a force at the skin itself would also drive motion that does not strain the
/// medium, and does not converge. With a medium above the skin: the force p/d on u_z at z = 0.
/// Velocities receive the load in the middle of their step, and half of it at t = 0.
///
/// PstdLoad::displacement: u_z at z = 0 is prescribed wherever a focus reaches more than a
/// thousandth of its peak during the run. The total velocity is prescribed, because k-Wave's
/// Dirichlet source sets one of three split parts only, and the skin then moves several times as
/// far. PstdLoad::velocity prescribes the velocity of the load's pattern instead of the rate of its
/// displacement. With PstdPrescribed::focus the nodes are prescribed only while a focus covers
/// them. Not collective.
Source load_source(const Case& c, const PstdOptions& options, const CaseGrid& grid, double step_s);

/// The number of its nodes, or their maximum if it depends on the motion of the load.
double most_source_nodes(const Case& c, const PstdOptions& options);

} // namespace shearwake::pstd
