// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "schedule/run/run_arguments.hpp"

namespace shearwake::optimise {

/// The command `optimise`: computes the best envelope of each case of a job with [optimise], an
/// upper bound with its certificate, and the cases of the result. Arguments of `run`, of which
/// `out` is the folder of the optima (default: out/<job name>.optimise). Collective.
ExitCode optimise_job(const schedule::RunArguments& arguments, const Comm& world);

} // namespace shearwake::optimise
