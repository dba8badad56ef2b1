// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

#include <functional>
#include <string>

namespace shearwake {

/// When MPI is initialised: always, or if mpirun or srun has started this process.
enum class MpiUse { always, with_launcher };

/// Initialises MPI, runs `program` on all ranks and finalises MPI. A UsageError is printed once and
/// determines the exit code. Any other exception is printed with its rank and context and aborts
/// all ranks. All ranks return the same exit code. Only this function ends the process.
/// Without `MpiUse::always`, the program on one rank works where MPI cannot be initialised, such as
/// on login nodes.
int guarded_main(int argc, char** argv, MpiUse use,
                 const std::function<ExitCode(const Comm&)>& program);

/// Seconds since guarded_main() began. Not collective.
double seconds_since_start();

/// Name and version of the linked MPI library, for example "Open MPI v4.1.4". Not collective.
std::string mpi_version();

/// As Comm::barrier() for long waits: ranks that wait sleep instead of occupying their cores, and
/// notice the last rank within a millisecond. Throws Error when MPI reports an error. Collective.
void sleeping_barrier(const Comm& comm);

} // namespace shearwake
