#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

#include <functional>

namespace shearwake {

/// The only function that ends the process. Starts MPI, runs `program` on all ranks, finishes MPI.
/// A UsageError is printed once and gives its own code; anything else that escapes prints its rank
/// and context and aborts all ranks. All ranks return the same code.
int guarded_main(int argc, char** argv, const std::function<ExitCode(const Comm&)>& program);

} // namespace shearwake
