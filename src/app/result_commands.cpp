// SPDX-License-Identifier: BSD-3-Clause
#include "app/declare_commands.hpp"

#include "app/commands.hpp"
#include "app/python_command.hpp"
#include "app/study_commands.hpp"
#include "base/text.hpp"
#include "bench/bench.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace shearwake::app {
namespace {

void add_status(CLI::App& app, Action& action, const std::string& folder) {
    auto arguments = std::make_shared<StatusArguments>();
    CLI::App* command = app.add_subcommand(
        "status",
        "count done, running, failed and remaining cases, and estimate the remaining time");
    command->add_option("DIR", arguments->folder, folder)->required();
    command->add_flag("--verify", arguments->verify,
                      "read every case file and check it against its checksum");
    add_json(command, arguments->json);
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
    add_json(command, arguments->json);
    command->add_flag("--quiet", arguments->quiet, "print only errors");
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
    add_json(command, arguments->json);
    command->callback([=, &action] {
        action = [=](const Comm& world) { return diff_command(*arguments, world); };
    });
}

void add_show(CLI::App& app, Action& action) {
    auto show = std::make_shared<ShowArguments>();
    auto arguments = std::make_shared<ShowModulationArguments>();
    CLI::App* command = app.add_subcommand("show", "describe one case, or draw a modulation");
    CLI::App* what = command->add_option_group("what"); // exactly one of the two
    CLI::Option* case_file = what->add_option("CASE", show->case_file, "case file (HDF5)");
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
    command
        ->add_flag("--json", show->json,
                   "print a JSON document instead of text (docs/reference/json-output.md)")
        ->needs(case_file);
    command->callback([=, &action] {
        action = [=](const Comm& world) {
            return show->case_file.empty() ? show_modulation_command(*arguments, world)
                                           : show_command(*show, world);
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
            "receptors; files: writing and verifying 1 GB of frames; "
            "machine: recalibrate the cost model of plan and run; estimates: compare estimates "
            "with measurements")
        ->check(one_of({"layered", "spectral", "pstd", "neural", "files", "machine", "estimates"}));
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
    command->add_flag("--rigid", arguments->rigid,
                      "spectral: a rigid cylinder of 5 mm radius instead of the body");
    command->add_flag("--lump", arguments->lump,
                      "spectral: a rigid ellipsoid of 12 x 10 x 6 mm instead of the body");
    command
        ->add_option("--sponge", arguments->sponge_mm,
                     "spectral: absorbing margin, mm (default 0: none)")
        ->type_name("MM")
        ->check(CLI::Range(0.0, 60.0));
    add_json(command, arguments->json);
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

} // namespace

CLI::Validator one_of(const std::vector<std::string>& words) {
    return CLI::Validator(
        [words](std::string& word) {
            if (std::find(words.begin(), words.end(), word) != words.end()) return std::string();
            const auto meant = nearest(word, words);
            return fmt::format("unknown value \"{}\"; {}", printable(word),
                               meant ? fmt::format("did you mean {}?", *meant)
                                     : "possible are " + quoted_list(words, "and"));
        },
        fmt::format("{{{}}}", fmt::join(words, ",")));
}

void add_result_commands(CLI::App& app, Action& action) {
    const std::string folder = "output folder of a run";
    add_status(app, action, folder);
    add_verify(app, action, folder);
    add_reduce(app, action);
    add_python_command(app, action, "report");
    add_python_command(app, action, "movie");
    add_diff(app, action);
    add_python_command(app, action, "compare");
    add_converge(app, action);
    add_optimise(app, action);
    add_show(app, action);
    add_respond(app, action);
    add_bench(app, action);
}

} // namespace shearwake::app
