// SPDX-License-Identifier: BSD-3-Clause
#include "app/optional_commands.hpp"
#include "app/study_commands.hpp"
#include "studies/optimise/optimise.hpp"

#include "app/commands.hpp"

namespace shearwake::app {
namespace {

/// The options of a command that runs the cases of a study.
void add_study_options(CLI::App* command, schedule::RunArguments& arguments) {
    command
        ->add_option("--walltime", arguments.walltime,
                     "start no case that cannot finish within this time")
        ->type_name("S|H:MM:SS");
    command->add_flag("--allow-mixed", arguments.allow_mixed,
                      "use results of another version of the program");
    command->add_flag("--retry-failed", arguments.retry_failed, "try failed cases again");
    command->add_flag("--force", arguments.force,
                      "run although the estimates exceed the memory or the disk");
    command->add_flag("--quiet", arguments.quiet, "print only errors");
}

} // namespace

void add_converge(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<ConvergeArguments>();
    CLI::App* command = app.add_subcommand(
        "converge", "estimate the numerical error: compute some cases with half the spacing, half "
                    "the time step and twice the domain");
    add_job(command, *arguments);
    command->add_option("--out", arguments->out,
                        "output folder of the sweep (default: out/<job name>); the study is in "
                        "its subfolder converge");
    command->add_option("--only", arguments->only, "study these cases, by id")
        ->type_name("ID[,ID]")
        ->delimiter(',');
    command
        ->add_option("--cases", arguments->cases,
                     "without --only: study N cases, from the first to the last (default 3), and "
                     "their references")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000));
    add_ranks_per_case(command, arguments->ranks_per_case);
    add_study_options(command, *arguments);
    command->callback([=, &action] {
        action = [=](const Comm& world) { return converge_command(*arguments, world); };
    });
}

void add_optimise(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<schedule::RunArguments>();
    CLI::App* command = app.add_subcommand(
        "optimise", "find the envelope with the largest efficiency for each case of a job with "
                    "[optimise], and prove an upper bound");
    add_job(command, *arguments);
    command->add_option("--out", arguments->out,
                        "output folder of the optima (default: out/<job name>.optimise)");
    add_ranks_per_case(command, arguments->ranks_per_case);
    add_study_options(command, *arguments);
    command->callback([=, &action] {
        action = [=](const Comm& world) {
            require_library(OptionalCommand::optimise);
            return optimise::optimise_job(*arguments, world);
        };
    });
}

void add_reduce(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<ReduceArguments>();
    CLI::App* command =
        app.add_subcommand("reduce", "write tables (CSV, Markdown) from the case files");
    command->add_option("DIR", arguments->folder, "output folder of a run")->required();
    command->add_flag_callback(
        "--errors", [=] { arguments->errors = reduce::ErrorColumns::added; },
        "add columns <column>_error with the errors that shearwake converge estimated");
    add_json(command, arguments->json);
    command->callback([=, &action] {
        action = [=](const Comm& world) { return reduce_command(*arguments, world); };
    });
}

} // namespace shearwake::app
