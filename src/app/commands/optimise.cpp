// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "studies/optimise/optimise.hpp"

namespace shearwake::app {
void add_optimise(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<schedule::RunArguments>(
        app, action, "optimise",
        "find the envelope with the largest efficiency for each case of a job with "
        "[optimise], and prove an upper bound",
        optimise::optimise_job);
    command.alias("optimize");
    add_job(command, arguments);
    command.add_option("--out", arguments.out,
                       "output folder of the optima (default: out/<job name>.optimise)");
    add_study_options(command, arguments);
}

} // namespace shearwake::app
