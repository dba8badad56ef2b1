// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "config/job.hpp"
#include "parallel/comm.hpp"
#include "schedule/run_arguments.hpp"

namespace shearwake::schedule {

/// The command `run`: computes the cases of a job that are not complete yet. Collective.
ExitCode run_sweep(const RunArguments& arguments, const Comm& world);

/// Computes the cases of this job, which every rank has, as `run` does. Collective.
ExitCode run_job(const config::Job& job, const RunArguments& arguments, const Comm& world);

} // namespace shearwake::schedule
