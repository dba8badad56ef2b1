// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"

#include "schedule/job_source.hpp"

#include <fmt/format.h>

namespace shearwake::app {

ExitCode check_command(const schedule::JobArguments& arguments, const Comm& world) {
    const config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    if (!world.is_root()) return ExitCode::done;
    for (const config::Diagnostic& diagnostic : job.diagnostics)
        fmt::print("{}\n", config::text(diagnostic));
    fmt::print("{}: {} case{}, {} warning{}, no errors\n", arguments.job.string(),
               job.plan.cases.size(), job.plan.cases.size() == 1 ? "" : "s", job.diagnostics.size(),
               job.diagnostics.size() == 1 ? "" : "s");
    return ExitCode::done;
}

} // namespace shearwake::app
