// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "schedule/run/run.hpp"

namespace shearwake::adaptive {

/// The command `run`. If the job has adaptive axes, evaluates the results, adds points and runs
/// their cases, until all axes have reached their tolerance or their limits. The plan in the output
/// folder grows with each round, so an interrupted run continues with the points of its last plan.
/// Collective over the world.
ExitCode adaptive_run(const schedule::RunArguments& arguments, const Comm& world);

} // namespace shearwake::adaptive
