// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

namespace shearwake {

/// As Comm::barrier() for long waits: ranks that wait sleep instead of occupying their cores, and
/// notice the last rank within a millisecond. Throws Error when MPI reports an error. Collective.
void sleeping_barrier(const Comm& comm);

} // namespace shearwake
