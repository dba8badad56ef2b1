// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "studies/adaptive/adaptive_run.hpp"

namespace shearwake::app {

void add_run(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<schedule::RunArguments>(
        app, action, "run", "run a job, or resume it: complete cases are skipped",
        adaptive::adaptive_run);
    add_job(command, arguments);
    command.add_option("--out", arguments.out, "output folder (default: out/<job name>)");
    add_study_options(command, arguments);
    add_value(command, "--only", arguments.only, "ID[,ID]", "only these cases, by id")
        ->delimiter(',');
    add_value(command, "--checkpoint-interval", arguments.checkpoints.interval_s, "S",
              "seconds between checkpoints of a running case (default 300; 0: only when "
              "the run is stopped)")
        ->check(CLI::NonNegativeNumber);
    add_value(command, "--checkpoint-steps", arguments.checkpoints.steps, "N",
              "write a checkpoint every N steps in addition (default 0: never)")
        ->check(CLI::NonNegativeNumber);
    command.add_flag("--extend", arguments.extend,
                     "accept a folder with another plan of the same name: keep the cases that this "
                     "job contains, compute the others");
    command.add_flag("--fail-fast", arguments.fail_fast, "stop at the first failed case");
    add_json(command, arguments.json);
}

} // namespace shearwake::app
