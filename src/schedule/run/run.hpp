// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "config/job.hpp"
#include "parallel/comm.hpp"
#include "schedule/run/run_arguments.hpp"

#include <nlohmann/json_fwd.hpp>

namespace shearwake::schedule {

/// Computes the cases of this job, which every rank has, as `run` does. The members of the JSON
/// document are stored in `document` on rank 0 if it is not null, and otherwise printed.
/// Collective.
ExitCode run_job(const config::Job& job, const RunArguments& arguments, const Comm& world,
                 nlohmann::ordered_json* document = nullptr);

} // namespace shearwake::schedule
