#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

#include <functional>
#include <string>

namespace shearwake {

/// The only function that ends the process. Starts MPI, runs `program` on all ranks, finishes MPI.
/// A UsageError is printed once and gives its own code; anything else that escapes prints its rank
/// and context and aborts all ranks. All ranks return the same code.
int guarded_main(int argc, char** argv, const std::function<ExitCode(const Comm&)>& program);

/// Prints the reason and ends all ranks at once with that code: for what one rank alone has met
/// where the others wait in a collective call. Not collective.
[[noreturn]] void abort_all_ranks(const std::string& reason, ExitCode code);

/// "Open MPI v4.1.4" of the library that is linked.
std::string mpi_version();

} // namespace shearwake
