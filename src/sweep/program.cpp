#include "sweep/commands.hpp"

#include "base/text.hpp"
#include "sweep/provenance.hpp"

#include <algorithm>
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <functional>
#include <optional>

namespace shearwake {
namespace {

/// What the command line chose to do; set by the callback of the verb that was given.
using Action = std::function<ExitCode(const Comm&)>;

void add_job(CLI::App* verb, JobArguments& arguments) {
    verb->add_option("JOB", arguments.job, "job file (TOML)")->required();
    verb->add_option("-S", arguments.overrides, "override a key of the job: -S load.peak_Pa=200")
        ->type_name("KEY=VALUE")
        ->take_all();
}

void add_check(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<JobArguments>();
    CLI::App* verb = app.add_subcommand("check", "tell every mistake in a job file at once");
    add_job(verb, *arguments);
    verb->callback([=, &action] {
        action = [=](const Comm& world) { return check_command(*arguments, world); };
    });
}

void add_plan(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<PlanArguments>();
    CLI::App* verb =
        app.add_subcommand("plan", "list the cases with their ids, grids, memory and time");
    add_job(verb, *arguments);
    verb->add_option("-n,--ranks", arguments->ranks, "plan for that many ranks")
        ->check(CLI::Range(1, 1000000));
    verb->add_option("--ranks-per-case", arguments->ranks_per_case, "ranks of a team (0: choose)")
        ->check(CLI::Range(0, 1000000));
    verb->callback([=, &action] {
        action = [=](const Comm& world) { return plan_command(*arguments, world); };
    });
}

void add_run(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<RunArguments>();
    CLI::App* verb =
        app.add_subcommand("run", "run a job, or go on with it: whole cases are skipped");
    add_job(verb, *arguments);
    verb->add_option("--out", arguments->out, "output folder (default: out/<job name>)");
    // "auto" is the word for 0.
    verb->add_option("--ranks-per-case", arguments->ranks_per_case, "ranks of a team, or auto")
        ->transform(CLI::Transformer(std::map<std::string, int>{{"auto", 0}}))
        ->check(CLI::Range(0, 1000000));
    verb->add_option("--only", arguments->only, "only these cases, by id")
        ->type_name("ID[,ID]")
        ->delimiter(',');
    verb->add_option("--shard", arguments->shard, "only every N-th case, from the I-th on")
        ->type_name("I/N");
    verb->add_option("--checkpoint-interval", arguments->checkpoints.interval_s,
                     "seconds between saves of a case at work (default 300; 0: at a stop only)")
        ->type_name("S")
        ->check(CLI::NonNegativeNumber);
    verb->add_option("--checkpoint-steps", arguments->checkpoints.steps,
                     "save every so many steps besides (0: no)")
        ->type_name("N")
        ->check(CLI::NonNegativeNumber);
    verb->add_option("--walltime", arguments->walltime,
                     "begin no case that will not end within (default: the Slurm job's limit)")
        ->type_name("S|H:MM:SS");
    verb->add_option("--log-json", arguments->log_json, "add the progress to this file as JSON")
        ->type_name("FILE");
    verb->add_flag("--allow-mixed", arguments->allow_mixed,
                   "go on in a folder with results of another version of the program");
    verb->add_flag("--retry-failed", arguments->retry_failed, "try failed cases again");
    verb->add_flag("--fail-fast", arguments->fail_fast, "stop at the first failed case");
    verb->add_flag("--quiet", arguments->quiet, "no progress, no warnings");
    verb->callback([=, &action] {
        action = [=](const Comm& world) { return run_command(*arguments, world); };
    });
}

using PathCommand = ExitCode (*)(const std::filesystem::path&, const Comm&);

void add_path_verb(CLI::App& app, Action& action, const std::string& name, const std::string& what,
                   const std::string& argument, const std::string& help, PathCommand command) {
    auto path = std::make_shared<std::filesystem::path>();
    CLI::App* verb = app.add_subcommand(name, what);
    verb->add_option(argument, *path, help)->required();
    verb->callback(
        [=, &action] { action = [=](const Comm& world) { return command(*path, world); }; });
}

void add_diff(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<DiffArguments>();
    CLI::App* verb = app.add_subcommand(
        "diff", "a table against another, with tolerances; exit 5 when they differ");
    verb->add_option("DIR", arguments->now, "output folder, or table (CSV)")->required();
    verb->add_option("BASELINE", arguments->reference, "what it is compared with, likewise")
        ->required();
    verb->add_option("--tolerance", arguments->tolerances,
                     "relative tolerance of a column (*: of all that are not named)")
        ->type_name("COLUMN=REL")
        ->allow_extra_args(false)
        ->take_all();
    verb->add_option("--tolerances", arguments->tolerance_file, "a file of tolerances (TOML)")
        ->type_name("FILE");
    verb->add_option("--json", arguments->json, "write every difference there as well")
        ->type_name("FILE");
    verb->callback([=, &action] {
        action = [=](const Comm& world) { return diff_command(*arguments, world); };
    });
}

void add_show(CLI::App& app, Action& action) {
    auto case_file = std::make_shared<std::filesystem::path>();
    auto arguments = std::make_shared<ShowModulationArguments>();
    CLI::App* verb = app.add_subcommand("show", "one case in words, or a modulation drawn");
    CLI::App* what = verb->add_option_group("what"); // one of the two
    what->add_option("CASE", *case_file, "case file (HDF5)");
    CLI::Option* job =
        what->add_option("--modulation", arguments->job,
                         "draw path, speed and envelope of the first case of this job")
            ->type_name("JOB");
    what->require_option(1);
    verb->add_option("--picture", arguments->picture,
                     "where to draw it: .png, .svg or .pdf (default: JOB.modulation.png)")
        ->type_name("FILE")
        ->needs(job);
    verb->add_option("-S", arguments->overrides, "override a key of the job")
        ->type_name("KEY=VALUE")
        ->take_all()
        ->needs(job);
    verb->callback([=, &action] {
        action = [=](const Comm& world) {
            return case_file->empty() ? show_modulation_command(*arguments, world)
                                      : show_command(*case_file, world);
        };
    });
}

void add_bench(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<BenchArguments>();
    CLI::App* verb = app.add_subcommand(
        "bench", "this machine's speed beside the floor that its FFTs and memory set");
    verb->add_option("ENGINE", arguments->engine,
                     "layered (default), spectral, pstd, neural, sweep: what cases cost beside "
                     "their solves, "
                     "or machine: all that plan believes of it")
        ->check(CLI::IsMember({"layered", "spectral", "pstd", "neural", "sweep", "machine"}));
    verb->add_option(
            "--grid", arguments->grid,
            "spectral: points and levels (256x192x25); pstd: points (128x96x32, 128x128x128)")
        ->type_name("NXxNYxNZ");
    verb->add_option("--steps", arguments->steps, "spectral, pstd: steps that are timed (20)")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000));
    verb->add_option("--contrast", arguments->contrast,
                     "spectral: stiffness of the body over the layer's (4; 1: no body)")
        ->type_name("C")
        ->check(CLI::Range(1.0, 1e6));
    verb->add_option("--sponge", arguments->sponge_mm, "spectral: absorbing margin, mm (0: none)")
        ->type_name("MM")
        ->check(CLI::Range(0.0, 60.0));
    verb->add_option("--cases", arguments->cases, "sweep: tiny cases that are computed (2000)")
        ->type_name("N")
        ->check(CLI::Range(4, 100000));
    verb->callback([=, &action] {
        action = [=](const Comm& world) { return bench_command(*arguments, world); };
    });
}

void add_respond(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<RespondArguments>();
    CLI::App* verb = app.add_subcommand(
        "respond",
        "what nerve fibres answer to a motion of the skin: spikes, without a simulation");
    verb->add_option("MOTION", arguments->motion,
                     "displacement at points or, with afferents.input=stress, stress at "
                     "receptors, CSV or HDF5; without: a prescribed carrier");
    verb->add_option("--group", arguments->group,
                     "group of the HDF5 file (default: traces, or its "
                     "root)");
    verb->add_option("--options", arguments->options, "a file with [afferents], such as a job")
        ->type_name("FILE");
    verb->add_option("-S", arguments->overrides, "override a key: -S afferents.where=hand")
        ->type_name("KEY=VALUE")
        ->take_all();
    verb->add_option("--out", arguments->out, "write the spikes there (HDF5)")->type_name("FILE");
    verb->add_option("--duration-ms", arguments->duration_ms, "of a prescribed carrier (1000)")
        ->check(CLI::Range(1.0, 1e5));
    verb->add_option("--modulation-Hz", arguments->modulation_Hz,
                     "frequency that the locking of spikes refers to")
        ->check(CLI::Range(1e-3, 1e6));
    verb->callback([=, &action] {
        action = [=](const Comm& world) { return respond_command(*arguments, world); };
    });
}

constexpr const char* footer =
    "A first sweep:\n"
    "  shearwake check jobs/quickstart.toml\n"
    "  mpirun -n 2 shearwake run jobs/quickstart.toml\n"
    "  shearwake reduce out/quickstart && shearwake report out/quickstart\n"
    "\n"
    "Exit codes: 0 done, 1 internal error, 2 usage, 3 bad job, 4 some cases failed,\n"
    "5 differs from baseline, 6 files or environment, 75 stopped early: start it again.";

/// The first word that should be a verb and is none. CLI11 would only say that one is required.
std::optional<std::string> unknown_verb(const CLI::App& app, int argc, char** argv) {
    if (argc < 2 || std::string_view(argv[1]).starts_with("-")) return std::nullopt;
    std::vector<std::string> verbs;
    for (const CLI::App* verb : app.get_subcommands({}))
        verbs.push_back(verb->get_name());
    const std::string word = argv[1];
    if (std::find(verbs.begin(), verbs.end(), word) != verbs.end()) return std::nullopt;
    const auto meant = nearest(word, verbs);
    return fmt::format("{} is no verb of shearwake; {}", word,
                       meant ? "did you mean " + *meant + "?"
                             : "there are " + quoted_list(verbs, "and"));
}

} // namespace

ExitCode program(int argc, char** argv, const Comm& world) {
    Action action;
    CLI::App app("shearwake: sweeps of mid-air ultrasound haptics over viscoelastic skin");
    app.require_subcommand(1);
    app.footer(footer);
    app.set_version_flag("--version", version_text());
    add_check(app, action);
    add_plan(app, action);
    add_run(app, action);
    const std::string folder = "output folder of a run";
    add_path_verb(app, action, "status", "done, running, failed, left, time to go", "DIR", folder,
                  status_command);
    add_path_verb(app, action, "reduce", "tables (CSV, Markdown) from the case files", "DIR",
                  folder, reduce_command);
    add_path_verb(app, action, "report", "figures and one HTML page", "DIR", folder,
                  report_command);
    add_diff(app, action);
    add_show(app, action);
    add_respond(app, action);
    add_bench(app, action);
    if (const auto message = unknown_verb(app, argc, argv)) throw UsageError(*message);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        const bool asked = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);
        if (world.is_root()) app.exit(error);
        return asked ? ExitCode::done : ExitCode::usage;
    }
    return action(world);
}

} // namespace shearwake
