// SPDX-License-Identifier: BSD-3-Clause
#include "app/python_command.hpp"

#include "app/reduce_folder.hpp"
#include "base/python_module.hpp"
#include "parallel/agree.hpp"
#include "schedule/run/output_folder.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace shearwake::app {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// Adds an argument, or an option with a value, that is handed on to the module.
CLI::Option* hand_on(CLI::App& command, const std::string& name, const std::string& text,
                     const std::string& type = "TEXT") {
    return command.add_option(name)->description(text)->type_name(type);
}

void hand_on_flag(CLI::App& command, const std::string& name, const std::string& text) {
    command.add_flag(name)->description(text);
}

void declare_report(CLI::App& command) {
    hand_on(command, "DIR", "output folder of a run")->required();
    hand_on(command, "--only",
            "where not all cases can be drawn, draw these, by id, and their references", "ID[,ID]")
        ->take_all();
    hand_on_flag(command, "--json",
                 "print a JSON document instead of text (docs/reference/json-output.md)");
}

void declare_movie(CLI::App& command) {
    hand_on(command, "CASE", "case file with several surfaces")->required();
    hand_on(command, "--out",
            "path of the movies without extension (default: that of the case file)", "NAME");
    hand_on(command, "--slow-down",
            "how many times slower than the motion (default: the run takes about 6 s)", "FLOAT")
        ->check(CLI::Range(1e-3, 1e9));
    hand_on(command, "--width", "width of the MP4 in pixels (default 960)", "INT")
        ->check(CLI::Range(160, 3840));
}

void declare_compare(CLI::App& command) {
    hand_on(command, "A", "case file (HDF5) or output folder")->required();
    hand_on(command, "B", "reference: case file or output folder")->required();
    hand_on(command, "--picture",
            "draw the fields and their difference into this file: .png, .svg or .pdf (of sweeps: "
            "the pair that differs most)",
            "FILE");
    hand_on_flag(command, "--all",
                 "list every pair, time, trace and column instead of those that differ most");
    hand_on_flag(command, "--json", "print the result as JSON");
}

void declare_export(CLI::App& command) {
    hand_on(command, "CASE", "case file (HDF5)")->required();
    hand_on(command, "--format",
            "format: uff (Universal File Format, type 58; default), csv, or mat (HDF5 for MATLAB "
            "and Octave)")
        ->check(one_of({"uff", "csv", "mat"}));
    hand_on_flag(command, "--binary", "with uff: binary instead of ASCII data");
    hand_on(command, "--out",
            "file (default: the id of the case with the extension of the format)");
}

void declare_explore(CLI::App& command) {
    hand_on(command, "--port", "port on 127.0.0.1 (default: any free one)", "N")
        ->check(CLI::Range(0, 65535));
    hand_on(command, "-n,--ranks", "ranks of the engine (default 1)", "N")
        ->check(CLI::Range(1, 1024));
    hand_on(command, "--out", "folder for the sweeps that the page starts (default: out)", "DIR");
    hand_on_flag(command, "--no-browser", "print the address without opening a browser");
}

// What precedes a module; each returns further arguments for it.

Words reduce_first(const Words& given) {
    reduce_folder(schedule::folder_of_results(given.front()), reduce::ErrorColumns::kept);
    return {};
}

/// Tables must be current. Throws UsageError if a path is neither a case file nor a folder.
Words prepare_comparison(const Words& given) {
    for (const fs::path path : {given.at(0), given.at(1)}) {
        if (!fs::exists(path))
            throw UsageError(
                fmt::format("{} is neither a case file nor an output folder; run the job "
                            "first",
                            path.string()),
                ExitCode::environment);
        if (path.extension() == ".toml") schedule::folder_of_results(path); // explains a job file
    }
    for (const fs::path path : {given.at(0), given.at(1)})
        if (fs::is_directory(path)) reduce_folder({path}, reduce::ErrorColumns::kept);
    return {};
}

Words program_path(const Words&) {
    return {"--program=" + fs::read_symlink("/proc/self/exe").string()};
}

struct PythonCommand {
    const char *name, *text, *module;
    const char* refusal; // the message if the module rejects the arguments (exit 2)
    const char* failure; // the message with another exit code
    void (*declare)(CLI::App& command);
    Words (*prepare)(const Words& given) = [](const Words&) { return Words{}; };
    const PythonPackages& packages = figure_packages;
};

const PythonCommand& command_named(const std::string& name) {
    static const PythonCommand commands[] = {
        {.name = "report",
         .text = "draw figures and write one HTML page",
         .module = "shearwake.report",
         .refusal = "no report was written",
         .failure = "the report failed",
         .declare = declare_report,
         .prepare = reduce_first},
        {.name = "movie",
         .text = "write a movie of the surface of a case (MP4, GIF)",
         .module = "shearwake.report.movie",
         .refusal = "the movie was not written",
         .failure = "the movie was not written",
         .declare = declare_movie},
        {.name = "compare",
         .text = "compare the fields, traces and columns of two cases or two sweeps, also of "
                 "different engines and resolutions",
         .module = "shearwake.report.compare",
         .refusal = "the arguments cannot be compared",
         .failure = "the comparison failed",
         .declare = declare_compare,
         .prepare = prepare_comparison},
        {.name = "export",
         .text = "write the scan of the vibrometer of a case for other programs",
         .module = "shearwake.laboratory.export_scan",
         .refusal = "the scan cannot be exported",
         .failure = "the export failed",
         .declare = declare_export},
        {.name = "explore",
         .text = "open a page in the browser that computes while settings are changed",
         .module = "shearwake.explore",
         .refusal = "the page ended with an error",
         .failure = "the page ended with an error",
         .declare = declare_explore,
         .prepare = program_path,
         .packages = explorer_packages}};
    return *std::ranges::find(commands, name, &PythonCommand::name);
}

/// Arguments first, then options as --name=value.
Words given_words(const CLI::App& command) {
    Words arguments, options;
    for (const CLI::Option* option : command.get_options()) {
        if (option->count() == 0) continue;
        const std::string value = fmt::format("{}", fmt::join(option->results(), ","));
        if (option->get_lnames().empty()) {
            arguments.push_back(value);
            continue;
        }
        const std::string name = "--" + option->get_lnames().front();
        const bool is_flag = option->get_items_expected_max() == 0;
        options.push_back(is_flag ? name : fmt::format("{}={}", name, value));
    }
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
}

/// The error in the messages of a module, without the word "error".
std::string error_in(const std::string& messages) {
    const std::string start = "error: ";
    const auto at = messages.rfind(start);
    if (at == std::string::npos) return "";
    const auto from = at + start.size();
    return messages.substr(from, messages.find('\n', from) - from);
}

} // namespace

ExitCode python_command(const std::string& name, const Words& given, const Comm& world) {
    ExitCode code = ExitCode::done; // of rank 0; the program exits with the largest of all ranks
    on_root(world, [&] {
        const PythonCommand& command = command_named(name);
        Words words = command.prepare(given);
        words.insert(words.begin(), given.begin(), given.end());
        const bool captures = std::ranges::find(given, "--json") != given.end();
        std::string messages;
        const int status = run_python_module(command.module, words, command.packages,
                                             captures ? &messages : nullptr);
        const std::string error = error_in(messages);
        if (error.empty()) fmt::print(stderr, "{}", messages);
        if (status == static_cast<int>(ExitCode::some_cases_failed))
            code = ExitCode::some_cases_failed;
        else if (status == static_cast<int>(ExitCode::usage))
            throw UsageError(error.empty() ? command.refusal : error);
        else if (status != 0)
            throw UsageError(error.empty() ? fmt::format("{} (exit {})", command.failure, status)
                                           : error,
                             ExitCode::environment);
    });
    return code;
}

void add_python_command(CLI::App& app, Action& action, const std::string& name) {
    const PythonCommand& command = command_named(name);
    CLI::App* declared = app.add_subcommand(name, command.text);
    command.declare(*declared);
    declared->callback([declared, name, &action] {
        action = [declared, name](const Comm& world) {
            return python_command(name, given_words(*declared), world);
        };
    });
}

} // namespace shearwake::app
