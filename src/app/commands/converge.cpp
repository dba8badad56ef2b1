// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "studies/converge/convergence.hpp"

namespace shearwake::app {

void add_converge(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<converge::ConvergeArguments>(
        app, action, "converge",
        "estimate the numerical error: compute some cases with half the spacing, half "
        "the time step and twice the domain",
        converge::converge_job);
    add_job(command, arguments);
    command.add_option("--out", arguments.out,
                       "output folder of the sweep (default: out/<job name>); the study is in "
                       "its subfolder converge");
    add_value(command, "--only", arguments.only, "ID[,ID]", "study these cases, by id")
        ->delimiter(',');
    add_value(command, "--cases", arguments.cases, "N",
              "without --only: study N cases, from the first to the last (default 3), and "
              "their references")
        ->check(CLI::Range(1, 1000000));
    add_study_options(command, arguments);
}

} // namespace shearwake::app
