// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "problem/case/optimise_options.hpp"
#include "problem/case/plan.hpp"
#include "schedule/run/run.hpp"

namespace shearwake::optimise {

/// Throws UsageError (bad_job) if a case of the plan cannot be optimised. Not collective.
void require_optimisable(const Plan& plan, const OptimiseOptions& options);

/// The command `optimise`: computes the cases and quadratic forms that the module
/// shearwake.studies.optimising requests, which searches for the best envelope of each case of a
/// job with [optimise] and for an upper bound. Arguments of `run`, of which `out` is the folder of
/// the optima (default: out/<job name>.optimise). Collective.
ExitCode optimise_job(const schedule::RunArguments& arguments, const Comm& world);

} // namespace shearwake::optimise
