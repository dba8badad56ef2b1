// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "base/python_module.hpp"
#include "parallel/comm.hpp"
#include "schedule/run/run.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace shearwake::app {

/// Runs the command that the command line names; set by the callback of its subcommand.
using Action = std::function<ExitCode(const Comm&)>;

template <class Arguments>
struct Declared {
    CLI::App& command;
    Arguments& arguments; // exist as long as the command
};

/// Declares a subcommand that calls execute(arguments, world). `action` must outlive the parsing.
template <class Arguments>
Declared<Arguments> add_command(CLI::App& app, Action& action, const std::string& name,
                                const std::string& text, auto execute) {
    auto arguments = std::make_shared<Arguments>();
    CLI::App* command = app.add_subcommand(name, text);
    command->callback(
        [=, &action] { action = [=](const Comm& world) { return execute(*arguments, world); }; });
    return {*command, *arguments};
}

/// Declares a subcommand without arguments that prints a text.
void add_text(CLI::App& app, Action& action, const std::string& name, const std::string& what,
              const std::function<std::string()>& text);

/// Declares an option whose value has the name `type` in the help.
template <class T>
CLI::Option* add_value(CLI::App& command, const std::string& names, T& value,
                       const std::string& type, const std::string& text) {
    return command.add_option(names, value, text)->type_name(type);
}

// Arguments that several commands have.

/// -S, unless `names` adds another name.
CLI::Option*
add_overrides(CLI::App& command, std::vector<std::string>& overrides,
              const std::string& text = "override a key of the job: -S load.peak_Pa=200",
              const std::string& names = "-S");
/// Prints the warnings about -S, for commands that report no others. Call it on rank 0.
void print_override_warnings(const config::Job& job);
/// JOB and -S.
void add_job(CLI::App& command, schedule::JobArguments& arguments);
/// --elsewhere
void add_elsewhere(CLI::App& command, schedule::Target& target);
/// --ranks-per-case, whose default is 0: chosen by the program.
void add_ranks_per_case(CLI::App& command, int& ranks);
/// The options of a command that runs the cases of a study.
void add_study_options(CLI::App& command, schedule::RunArguments& arguments);
/// --json, for a document instead of text.
CLI::Option* add_json(CLI::App& command, bool& json);

/// Accepts these values only, and suggests the nearest one otherwise. The help lists them, from
/// which the shell completes them.
CLI::Validator one_of(const std::vector<std::string>& values);

/// Texts of the options of commands that read a scan.
namespace scan_texts {
constexpr const char *data = "scan: UFF 58 (ASCII or binary), MATLAB (5 or 7.3), CSV, HDF5 or a "
                             "case file",
                     *least_quality = "ignore points below this quality, 0 to 1 (default 0: only "
                                      "those without a signal)",
                     *outwards =
                         "z and positive velocities of DATA point out of the skin, as those "
                         "of most scanners do (default: into the skin)",
                     *out = "output folder (default: named after the job, in out)";
} // namespace scan_texts

struct PythonCommand;

/// Executes such a command. Collective; rank 0 does the work.
ExitCode execute(const PythonCommand& command, const std::vector<std::string>& arguments,
                 const Comm& world);

/// A command that a module of the Python package executes.
struct PythonCommand {
    const char* module;
    const char* rejection; // the message if the module rejects the arguments (exit 2)
    const char* failure;   // the message with another exit code
    /// What precedes the module; returns further arguments for it.
    std::vector<std::string> (*prepare)(const std::vector<std::string>& arguments) =
        [](const std::vector<std::string>&) { return std::vector<std::string>{}; };
    const PythonPackages& packages = figure_packages;
    ExitCode result = ExitCode::some_cases_failed; // an exit code that is no error
    decltype(&app::execute) execute = app::execute;
};

/// Declares such a command, to which options can be added. The module receives the arguments and
/// options that are given.
CLI::App& add_python_command(CLI::App& app, Action& action, const std::string& name,
                             const std::string& text, const PythonCommand& command);
/// Adds an argument, or an option with a value, that is passed to the module.
CLI::Option* pass_option(CLI::App& command, const std::string& name, const std::string& text,
                         const std::string& type = "TEXT");
void pass_flag(CLI::App& command, const std::string& name, const std::string& text);

} // namespace shearwake::app
