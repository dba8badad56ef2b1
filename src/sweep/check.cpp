#include "sweep/commands.hpp"

#include "sweep/job_source.hpp"

#include <fmt/format.h>

namespace shearwake {

ExitCode check_command(const JobArguments& arguments, const Comm& world) {
    const Job job = load_job(arguments.job, arguments.overrides, world);
    if (!world.is_root()) return ExitCode::done;
    for (const Finding& finding : job.findings)
        fmt::print("{}\n", text(finding));
    fmt::print("{}: {} case{}, {} warning{}, no mistakes\n", arguments.job.string(),
               job.plan.cases.size(), job.plan.cases.size() == 1 ? "" : "s", job.findings.size(),
               job.findings.size() == 1 ? "" : "s");
    return ExitCode::done;
}

} // namespace shearwake
