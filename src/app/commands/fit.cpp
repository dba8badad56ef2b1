// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/laboratory.hpp"

#include "app/commands/commands.hpp"

namespace shearwake::app {
namespace {

ExitCode fit_command(const laboratory::ScanArguments& arguments, const Comm& world) {
    require_library("fit");
    return laboratory::fit_job(arguments, world);
}

} // namespace

void add_fit(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<laboratory::ScanArguments>(
        app, action, "fit", "estimate the keys of [uncertain] of a job from a measured scan",
        fit_command);
    command
        .add_option("JOB", arguments.job,
                    "job file (TOML); the distributions of [uncertain] are bounds and priors")
        ->required();
    add_scan(command, "--data", arguments.data)->type_name("DATA");
    add_scan_options(command, arguments);
}

} // namespace shearwake::app
