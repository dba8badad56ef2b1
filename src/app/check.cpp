// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"

#include "pipeline/memory.hpp"
#include "schedule/job_source.hpp"
#include "schedule/machine_limits.hpp"

#include <fmt/format.h>

namespace shearwake::app {

ExitCode check_command(const CheckArguments& arguments, const Comm& world) {
    const config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    const double memory_B = pipeline::memory_per_rank_B(world);
    if (!world.is_root()) return ExitCode::done;
    for (const config::Diagnostic& diagnostic : job.diagnostics)
        fmt::print("{}\n", config::text(diagnostic));
    if (arguments.target == schedule::Target::this_machine) {
        const std::string error =
            schedule::excess(schedule::least_demand(job.plan.cases, world.size()), memory_B,
                             std::filesystem::path("out") / job.plan.name);
        if (!error.empty()) {
            fmt::print("{}\n", error);
            return ExitCode::bad_job;
        }
    }
    fmt::print("{}: {} case{}, {} warning{}, no errors\n", arguments.job.string(),
               job.plan.cases.size(), job.plan.cases.size() == 1 ? "" : "s", job.diagnostics.size(),
               job.diagnostics.size() == 1 ? "" : "s");
    return ExitCode::done;
}

} // namespace shearwake::app
