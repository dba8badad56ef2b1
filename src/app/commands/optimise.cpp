// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "studies/optimise/optimise_study.hpp"

namespace shearwake::app {
namespace {

ExitCode optimise_command(const schedule::RunArguments& arguments, const Comm& world) {
    require_library("optimise");
    return optimise::optimise_job(arguments, world);
}

} // namespace

void add_optimise(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<schedule::RunArguments>(
        app, action, "optimise",
        "find the envelope with the largest efficiency for each case of a job with "
        "[optimise], and prove an upper bound",
        optimise_command);
    add_job(command, arguments);
    command.add_option("--out", arguments.out,
                       "output folder of the optima (default: out/<job name>.optimise)");
    add_study_options(command, arguments);
}

} // namespace shearwake::app
