// SPDX-License-Identifier: BSD-3-Clause
#include "app/command_line_text.hpp"
#include "app/commands.hpp"
#include "app/movie.hpp"
#include "app/study_commands.hpp"

#include "base/text.hpp"
#include "bench/bench.hpp"
#include "config/key_table.hpp"
#include "config/schema.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/run.hpp"

#include <algorithm>
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <functional>
#include <optional>

namespace shearwake::app {
namespace {

void add_job(CLI::App* command, schedule::JobArguments& arguments) {
    command->add_option("JOB", arguments.job, "job file (TOML)")->required();
    command->add_option("-S", arguments.overrides, "override a key of the job: -S load.peak_Pa=200")
        ->type_name("KEY=VALUE")
        ->take_all();
}

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
    command->callback([=, &action] {
        action = [=](const Comm& world) { return check_command(*arguments, world); };
    });
}

void add_ranks_per_case(CLI::App* command, int& ranks) {
    command->add_option("--ranks-per-case", ranks, "ranks per team (default: auto)")
        ->type_name("N|auto")
        ->transform(CLI::Transformer(std::map<std::string, int>{{"auto", 0}}).description(""))
        ->check(CLI::Range(0, 1000000).description(""));
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
    command->add_flag("--quiet", arguments->quiet, "print no progress and no warnings");
    command->callback([=, &action] {
        action = [=](const Comm& world) { return schedule::run_sweep(*arguments, world); };
    });
}

using PathCommand = ExitCode (*)(const std::filesystem::path&, const Comm&);

void add_path_command(CLI::App& app, Action& action, const std::string& name,
                      const std::string& description, const std::string& argument,
                      const std::string& help, PathCommand function) {
    auto path = std::make_shared<std::filesystem::path>();
    CLI::App* command = app.add_subcommand(name, description);
    command->add_option(argument, *path, help)->required();
    command->callback(
        [=, &action] { action = [=](const Comm& world) { return function(*path, world); }; });
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

void add_status(CLI::App& app, Action& action, const std::string& folder) {
    auto arguments = std::make_shared<StatusArguments>();
    CLI::App* command = app.add_subcommand(
        "status",
        "count done, running, failed and remaining cases, and estimate the remaining time");
    command->add_option("DIR", arguments->folder, folder)->required();
    command->add_flag("--verify", arguments->verify,
                      "read every case file and check it against its checksum");
    command->callback([=, &action] {
        action = [=](const Comm& world) { return status_command(*arguments, world); };
    });
}

void add_verify(CLI::App& app, Action& action, const std::string& folder) {
    auto arguments = std::make_shared<VerifyArguments>();
    CLI::App* command = app.add_subcommand(
        "verify", "check case files, plan, journals and index against their checksums; exit 4 "
                  "if any of them is damaged");
    command->add_option("DIR", arguments->folder, folder)->required();
    command->add_option("--json", arguments->json, "write the result to this file as JSON")
        ->type_name("FILE");
    command->add_flag("--quiet", arguments->quiet, "print no progress");
    command->callback([=, &action] {
        action = [=](const Comm& world) { return verify_command(*arguments, world); };
    });
}

void add_diff(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<DiffArguments>();
    CLI::App* command =
        app.add_subcommand("diff", "compare two tables, with tolerances; exit 5 if they differ");
    command->add_option("DIR", arguments->now, "output folder, or table (CSV)")->required();
    command
        ->add_option("BASELINE", arguments->reference,
                     "reference to compare with: output folder, or table (CSV)")
        ->required();
    command
        ->add_option("--tolerance", arguments->tolerances,
                     "relative tolerance of a column (*: of all columns that are not named)")
        ->type_name("COLUMN=REL")
        ->allow_extra_args(false)
        ->take_all();
    command->add_option("--tolerances", arguments->tolerance_file, "file with tolerances (TOML)")
        ->type_name("FILE");
    command->add_option("--json", arguments->json, "write all differences to this file as JSON")
        ->type_name("FILE");
    command->callback([=, &action] {
        action = [=](const Comm& world) { return diff_command(*arguments, world); };
    });
}

void add_show(CLI::App& app, Action& action) {
    auto case_file = std::make_shared<std::filesystem::path>();
    auto arguments = std::make_shared<ShowModulationArguments>();
    CLI::App* command = app.add_subcommand("show", "describe one case, or draw a modulation");
    CLI::App* what = command->add_option_group("what"); // exactly one of the two
    what->add_option("CASE", *case_file, "case file (HDF5)");
    CLI::Option* job =
        what->add_option("--modulation", arguments->job,
                         "draw path, speed and envelope of the first case of this job")
            ->type_name("JOB");
    what->require_option(1);
    command
        ->add_option("--picture", arguments->picture,
                     "file for the drawing: .png, .svg or .pdf (default: JOB.modulation.png)")
        ->type_name("FILE")
        ->needs(job);
    command->add_option("-S", arguments->overrides, "override a key of the job")
        ->type_name("KEY=VALUE")
        ->take_all()
        ->needs(job);
    command->callback([=, &action] {
        action = [=](const Comm& world) {
            return case_file->empty() ? show_modulation_command(*arguments, world)
                                      : show_command(*case_file, world);
        };
    });
}

void add_bench(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<bench::BenchArguments>();
    CLI::App* command = app.add_subcommand(
        "bench", "measure this machine's speed and compare it with the lower bound set by FFTs and "
                 "memory bandwidth");
    command
        ->add_option(
            "NAME", arguments->engine,
            "layered (default), spectral, pstd or neural: the speed of an engine or of the "
            "receptors; sweep: overhead per case; files: writing and verifying 1 GB of frames; "
            "machine: recalibrate the cost model of plan and run; estimates: compare estimates "
            "with measurements")
        ->check(CLI::IsMember(
            {"layered", "spectral", "pstd", "neural", "sweep", "files", "machine", "estimates"}));
    command
        ->add_option(
            "--grid", arguments->grid,
            "spectral: points and levels (default 256x192x25); pstd: points (default 128x96x32 and "
            "128x128x128)")
        ->type_name("NXxNYxNZ");
    command
        ->add_option("--steps", arguments->steps,
                     "spectral, pstd: number of timed steps (default 20)")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000));
    command
        ->add_option(
            "--contrast", arguments->contrast,
            "spectral: stiffness of the body relative to the layer (default 4; 1: no body)")
        ->type_name("C")
        ->check(CLI::Range(1.0, 1e6));
    command
        ->add_option("--sponge", arguments->sponge_mm,
                     "spectral: absorbing margin, mm (default 0: none)")
        ->type_name("MM")
        ->check(CLI::Range(0.0, 60.0));
    command->add_option("--cases", arguments->cases, "sweep: number of small cases (default 2000)")
        ->type_name("N")
        ->check(CLI::Range(4, 100000));
    command->callback([=, &action] {
        action = [=](const Comm& world) { return bench::bench_command(*arguments, world); };
    });
}

void add_respond(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<RespondArguments>();
    CLI::App* command = app.add_subcommand(
        "respond",
        "compute the spikes of nerve fibres for a given motion of the skin, without a simulation");
    command->add_option(
        "MOTION", arguments->motion,
        "CSV or HDF5 file with the displacement at points (with afferents.input=stress: the stress "
        "at the receptors). If it is omitted, the carrier of afferents.carrier is used");
    command->add_option("--group", arguments->group,
                        "group of the HDF5 file (default: traces, or the root group)");
    command
        ->add_option("--options", arguments->options,
                     "file with a table [afferents], for example a job")
        ->type_name("FILE");
    command->add_option("-S", arguments->overrides, "override a key: -S afferents.where=hand")
        ->type_name("KEY=VALUE")
        ->take_all();
    command->add_option("--out", arguments->out, "write the spikes to this file (HDF5)")
        ->type_name("FILE");
    command
        ->add_option("--duration-ms", arguments->duration_ms,
                     "duration of a prescribed carrier (default 1000)")
        ->check(CLI::Range(1.0, 1e5));
    command
        ->add_option("--modulation-Hz", arguments->modulation_Hz,
                     "reference frequency for the phase locking of spikes")
        ->check(CLI::Range(1e-3, 1e6));
    command->callback([=, &action] {
        action = [=](const Comm& world) { return respond_command(*arguments, world); };
    });
}

const std::string footer = "A first sweep:\n"
                           "  shearwake check jobs/quickstart.toml\n"
                           "  mpirun -n 2 shearwake run jobs/quickstart.toml\n"
                           "  shearwake reduce out/quickstart && shearwake report out/quickstart\n"
                           "\n";

/// The command of this name. Throws UsageError with the nearest name when there is none.
const CLI::App* find_command(const CLI::App& app, const std::string& name) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) {
        if (command->get_name() == name) return command;
        names.push_back(command->get_name());
    }
    const auto meant = nearest(name, names);
    throw UsageError(fmt::format("unknown command: {}; {}", name,
                                 meant ? "did you mean " + *meant + "?"
                                       : "the commands are " + quoted_list(names, "and")));
}

void add_help(CLI::App& app, Action& action) {
    auto name = std::make_shared<std::string>();
    CLI::App* command = app.add_subcommand("help", "print the help of a command");
    command->add_option("COMMAND", *name, "command to describe (default: the program)");
    command->callback([=, &app, &action] {
        action = [=, &app](const Comm& world) {
            // App::help() of the program would print the help of this command, which was selected.
            const CLI::App* about = name->empty() ? &app : find_command(app, *name);
            const std::string called = name->empty() ? "shearwake" : "shearwake " + *name;
            if (world.is_root())
                fmt::print("{}", about->get_formatter()->make_help(about, called,
                                                                   CLI::AppFormatMode::Normal));
            return ExitCode::done;
        };
    });
}

/// A command without arguments that prints a text about the program itself.
void add_text(CLI::App& app, Action& action, const std::string& name, const std::string& what,
              std::function<std::string()> text) {
    app.add_subcommand(name, what)->callback([=, &action] {
        action = [=](const Comm& world) {
            if (world.is_root()) fmt::print("{}", text());
            return ExitCode::done;
        };
    });
}

} // namespace

ExitCode program(int argc, char** argv, const Comm& world) {
    Action action;
    CLI::App app("shearwake: parameter sweeps of mid-air ultrasound haptics on viscoelastic skin");
    app.require_subcommand(1);
    app.footer("shearwake --help explains the exit codes."); // of each command
    app.set_version_flag("--version", pipeline::version_text());
    add_check(app, action);
    add_keys(app, action);
    add_schema(app, action);
    add_plan(app, action);
    add_run(app, action);
    const std::string folder = "output folder of a run";
    add_status(app, action, folder);
    add_verify(app, action, folder);
    add_reduce(app, action);
    add_path_command(app, action, "report", "draw figures and write one HTML page", "DIR", folder,
                     report_command);
    add_movie(app, action);
    add_diff(app, action);
    add_compare(app, action);
    add_converge(app, action);
    add_show(app, action);
    add_respond(app, action);
    add_bench(app, action);
    add_help(app, action);
    add_text(app, action, "version", "print the version of the program and its libraries",
             [] { return pipeline::version_text() + "\n"; });
    add_text(app, action, "man", "print the manual page, in the format of man(7)",
             [&app] { return man_page(app); });
    add_text(app, action, "completion", "print a script that completes commands in bash",
             [&app] { return bash_completion(app); });
    app.footer(footer + exit_code_list());
    // CLI11 would only report that a command is required.
    if (argc > 1 && argv[1][0] != '-') find_command(app, argv[1]);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        const bool is_help = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);
        if (world.is_root()) app.exit(error);
        return is_help ? ExitCode::done : ExitCode::usage;
    }
    return action(world);
}

} // namespace shearwake::app
