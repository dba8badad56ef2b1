// SPDX-License-Identifier: BSD-3-Clause
#include "app/declare_commands.hpp"

#include "app/commands.hpp"
#include "config/keys/key_table.hpp"
#include "config/keys/schema.hpp"
#include "schedule/run/run.hpp"
#include "studies/adaptive/adaptive_run.hpp"

#include <fmt/format.h>

namespace shearwake::app {
namespace {

void add_elsewhere(CLI::App* command, CheckArguments& arguments) {
    command->add_flag_callback(
        "--elsewhere", [&arguments] { arguments.target = schedule::Target::elsewhere; },
        "another machine runs the job: do not compare it with the memory and disk of this one");
}

void add_check(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<CheckArguments>();
    CLI::App* command = app.add_subcommand("check", "report all errors in a job file");
    add_job(command, *arguments);
    add_elsewhere(command, *arguments);
    add_json(command, arguments->json);
    command->callback([=, &action] {
        action = [=](const Comm& world) { return check_command(*arguments, world); };
    });
}

void add_plan(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<PlanArguments>();
    CLI::App* command =
        app.add_subcommand("plan", "list the cases with their ids, grids, memory and time");
    add_job(command, *arguments);
    add_elsewhere(command, *arguments);
    command
        ->add_option("-n,--ranks", arguments->ranks,
                     "plan for N ranks (default: the number of ranks that run this command)")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000));
    add_ranks_per_case(command, arguments->ranks_per_case);
    command->add_flag("--all", arguments->all_cases, "list every case, also of a long plan");
    add_json(command, arguments->json);
    command->callback([=, &action] {
        action = [=](const Comm& world) { return plan_command(*arguments, world); };
    });
}

void add_run(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<schedule::RunArguments>();
    CLI::App* command =
        app.add_subcommand("run", "run a job, or resume it: complete cases are skipped");
    add_job(command, *arguments);
    command->add_option("--out", arguments->out, "output folder (default: out/<job name>)");
    add_ranks_per_case(command, arguments->ranks_per_case);
    command->add_option("--only", arguments->only, "only these cases, by id")
        ->type_name("ID[,ID]")
        ->delimiter(',');
    command->add_option("--shard", arguments->shard, "only every N-th case, starting from the I-th")
        ->type_name("I/N");
    command
        ->add_option("--checkpoint-interval", arguments->checkpoints.interval_s,
                     "seconds between checkpoints of a running case (default 300; 0: only when "
                     "the run is stopped)")
        ->type_name("S")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option("--checkpoint-steps", arguments->checkpoints.steps,
                     "write a checkpoint every N steps in addition (default 0: never)")
        ->type_name("N")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option("--walltime", arguments->walltime,
                     "start no case that cannot finish within this time (default: the limit of the "
                     "Slurm job)")
        ->type_name("S|H:MM:SS");
    command
        ->add_option("--log-json", arguments->log_json,
                     "append progress to this file as lines of JSON")
        ->type_name("FILE");
    command->add_flag("--allow-mixed", arguments->allow_mixed,
                      "continue in a folder with results of another version of the program");
    command->add_flag("--retry-failed", arguments->retry_failed, "try failed cases again");
    command->add_flag("--fail-fast", arguments->fail_fast, "stop at the first failed case");
    command->add_flag("--force", arguments->force,
                      "run although the estimates exceed the memory or the disk");
    command->add_flag("--quiet", arguments->quiet, "print only errors");
    add_json(command, arguments->json);
    command->callback([=, &action] {
        action = [=](const Comm& world) { return adaptive::adaptive_run(*arguments, world); };
    });
}

void add_evaluate(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<EvaluateArguments>();
    CLI::App* command = app.add_subcommand(
        "evaluate", "compute one case of a job, without its sweep, and print its measures");
    command->add_option("JOB", arguments->job, "job file (TOML)")->required();
    command
        ->add_option("--set,-S", arguments->overrides,
                     "set a key of the job: --set medium.layer[1].c_s_m_s=4.5")
        ->type_name("KEY=VALUE")
        ->take_all();
    command->add_option("--out", arguments->out,
                        "folder of the evaluated cases (default: out/<job name>.evaluate); a case "
                        "that it contains is not computed again");
    add_json(command, arguments->json);
    command->callback([=, &action] {
        action = [=](const Comm& world) { return evaluate_command(*arguments, world); };
    });
}

void add_lens(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<LensArguments>();
    CLI::App* command = app.add_subcommand(
        "lens", "write the thickness (STL, PNG) and the field of the acoustic lens of a job");
    add_job(command, *arguments);
    command->add_option("--out", arguments->out, "output folder (default: out/<job name>.lens)");
    command->callback([=, &action] {
        action = [=](const Comm& world) { return lens_command(*arguments, world); };
    });
}

void add_keys(CLI::App& app, Action& action) {
    CLI::App* command =
        app.add_subcommand("keys", "print the reference of all keys of a job as Markdown");
    command->callback([&action] {
        action = [](const Comm& world) {
            if (world.is_root()) fmt::print("{}", config::key_reference());
            return ExitCode::done;
        };
    });
}

void add_schema(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand(
        "schema", "print the JSON Schema of job files, for completion and checking in editors");
    command->callback([&action] {
        action = [](const Comm& world) {
            if (world.is_root()) fmt::print("{}", config::job_schema());
            return ExitCode::done;
        };
    });
}

} // namespace

void add_json(CLI::App* command, bool& json) {
    command->add_flag("--json", json,
                      "print a JSON document instead of text (docs/reference/json-output.md)");
}

void add_job(CLI::App* command, schedule::JobArguments& arguments) {
    command->add_option("JOB", arguments.job, "job file (TOML)")->required();
    command->add_option("-S", arguments.overrides, "override a key of the job: -S load.peak_Pa=200")
        ->type_name("KEY=VALUE")
        ->take_all();
}

void add_ranks_per_case(CLI::App* command, int& ranks) {
    command->add_option("--ranks-per-case", ranks, "ranks per team (default: auto)")
        ->type_name("N|auto")
        ->transform(CLI::Transformer(std::map<std::string, int>{{"auto", 0}}).description(""))
        ->check(CLI::Range(0, 1000000).description(""));
}

void add_job_commands(CLI::App& app, Action& action) {
    add_check(app, action);
    add_keys(app, action);
    add_schema(app, action);
    add_plan(app, action);
    add_run(app, action);
    add_evaluate(app, action);
    add_lens(app, action);
}

} // namespace shearwake::app
