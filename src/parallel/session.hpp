// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

#include <functional>
#include <string>

namespace shearwake {

/// Initialises MPI, runs `program` on all ranks and finalises MPI. A UsageError is printed once and
/// determines the exit code. Any other exception is printed with its rank and context and aborts
/// all ranks. All ranks return the same exit code. Only this function ends the process.
/// `needs_mpi`: false for a program on one rank that works where MPI cannot be initialised, such as
/// on login nodes; it is nevertheless initialised if mpirun or srun has started this process.
int guarded_main(int argc, char** argv, bool needs_mpi,
                 const std::function<ExitCode(const Comm&)>& program);

/// Seconds since guarded_main() began. Not collective.
double seconds_since_start();

/// Name and version of the linked MPI library, for example "Open MPI v4.1.4". Not collective.
std::string mpi_version();

/// As Comm::barrier() for long waits: ranks that wait sleep instead of occupying their cores, and
/// notice the last rank within a millisecond. Throws Error when MPI reports an error. Collective.
void sleeping_barrier(const Comm& comm);

} // namespace shearwake
