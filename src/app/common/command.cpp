// SPDX-License-Identifier: BSD-3-Clause
#include "app/common/command.hpp"

#include "base/text.hpp"
#include "pipeline/provenance.hpp"
#include "studies/laboratory/least_squares.hpp"
#include "studies/optimise/search/best_envelope.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>

namespace shearwake::app {
namespace {

struct Library {
    std::string_view command, name, debian, root;
    bool exists;
};

std::array<Library, 2> optional_libraries() {
    return {{{"fit", "Ceres Solver", "libceres-dev", "Ceres", laboratory::can_fit},
             {"optimise", "NLopt", "libnlopt-dev", "NLopt", optimise::can_search}}};
}

} // namespace

void add_text(CLI::App& app, Action& action, const std::string& name, const std::string& what,
              const std::function<std::string()>& text) {
    app.add_subcommand(name, what)->callback([=, &action] {
        action = [=](const Comm& world) {
            if (world.is_root()) fmt::print("{}", text());
            return ExitCode::done;
        };
    });
}

CLI::Option* add_overrides(CLI::App& command, std::vector<std::string>& overrides,
                           const std::string& text, const std::string& names) {
    return add_value(command, names, overrides, "KEY=VALUE", text)->take_all();
}

void print_override_warnings(const config::Job& job) {
    for (const config::Diagnostic& diagnostic : job.diagnostics)
        if (diagnostic.file.starts_with("-S "))
            fmt::print(stderr, "{}\n", coloured(config::text(diagnostic), stderr));
}

void add_job(CLI::App& command, schedule::JobArguments& arguments) {
    command.add_option("JOB", arguments.job, "job file (TOML)")->required();
    add_overrides(command, arguments.overrides);
}

void add_elsewhere(CLI::App& command, schedule::Target& target) {
    command.add_flag_callback(
        "--elsewhere", [&target] { target = schedule::Target::elsewhere; },
        "another machine runs the job: do not compare it with the memory and disk of this one");
}

void add_ranks_per_case(CLI::App& command, int& ranks) {
    add_value(command, "--ranks-per-case", ranks, "N|auto", "ranks per team (default: auto)")
        ->transform(CLI::Transformer(std::map<std::string, int>{{"auto", 0}}).description(""))
        ->check(CLI::Range(0, 1000000).description(""));
}

void add_study_options(CLI::App& command, schedule::RunArguments& arguments) {
    add_ranks_per_case(command, arguments.ranks_per_case);
    add_value(command, "--walltime", arguments.walltime, "S|H:MM:SS",
              "start no case that cannot finish within this time (default: the limit of the "
              "Slurm job)");
    command.add_flag("--allow-mixed", arguments.allow_mixed,
                     "continue in a folder with results of another version of the program");
    command.add_flag("--retry-failed", arguments.retry_failed, "try failed cases again");
    command.add_flag("--force", arguments.force,
                     "run although the estimates exceed the memory or the disk");
    command.add_flag("--quiet", arguments.quiet, "print only errors");
}

CLI::Option* add_scan(CLI::App& command, const std::string& name, std::filesystem::path& data) {
    return command
        .add_option(name, data,
                    "scan: UFF 58 (ASCII or binary), MATLAB (5 or 7.3), CSV, HDF5 or a case file")
        ->required();
}

void add_scan_options(CLI::App& command, laboratory::ScanArguments& arguments) {
    add_overrides(command, arguments.overrides);
    add_value(command, "--least-quality", arguments.least_quality, "Q",
              "ignore points below this quality, 0 to 1 (default 0: only those without a "
              "signal)")
        ->check(CLI::Range(0.0, 1.0));
    command.add_flag("--outwards", arguments.outwards,
                     "z and positive velocities of DATA point out of the skin, as those of most "
                     "scanners do (default: into the skin)");
    add_value(command, "--out", arguments.out, "DIR",
              "output folder (default: named after the job, in out)");
}

CLI::Option* add_json(CLI::App& command, bool& json) {
    return command.add_flag(
        "--json", json, "print a JSON document instead of text (docs/reference/json-output.md)");
}

CLI::Validator one_of(const std::vector<std::string>& values) {
    return CLI::Validator(
        [values](std::string& value) {
            if (std::ranges::find(values, value) != values.end()) return std::string();
            const auto meant = nearest(value, values);
            return fmt::format("unknown value \"{}\"; {}", printable(value),
                               meant ? fmt::format("did you mean {}?", *meant)
                                     : "possible are " + quoted_list(values, "and"));
        },
        fmt::format("{{{}}}", fmt::join(values, ",")));
}

void require_library(const std::string& command) {
    for (const Library& library : optional_libraries())
        if (library.command == command && !library.exists)
            throw UsageError(
                fmt::format("this shearwake was built without {0}, which {1} needs; install {0} "
                            "(Debian: {2}), configure with -D{3}_ROOT=FOLDER if it is in a folder "
                            "of its own, and build again",
                            library.name, command, library.debian, library.root),
                ExitCode::environment);
}

std::string full_version_text() {
    std::string text = pipeline::version_text();
    for (const Library& library : optional_libraries())
        if (!library.exists)
            text += fmt::format("\nmissing   {}: built without {}", library.command, library.name);
    return text;
}

} // namespace shearwake::app
