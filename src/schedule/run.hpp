// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "schedule/run_arguments.hpp"

namespace shearwake::schedule {

/// The command `run`: computes the cases of a job that are not complete yet. Collective.
ExitCode run_sweep(const RunArguments& arguments, const Comm& world);

} // namespace shearwake::schedule
