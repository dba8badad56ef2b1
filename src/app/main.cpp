// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "config/job.hpp"
#include "parallel/session.hpp"
#include "pipeline/provenance.hpp"
#include "storage/hdf5/h5.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <span>
#include <string_view>

namespace shearwake::app {
namespace {

// The only text about them: --help and docs/reference/exit-codes.md show it.
constexpr std::pair<ExitCode, std::string_view> exit_codes[] = {
    {ExitCode::done, "The command succeeded."},
    {ExitCode::internal, "'compare' found a difference. Otherwise an internal error occurred: "
                         "please report it."},
    {ExitCode::usage, "The command line is invalid, or a folder does not fit the job."},
    {ExitCode::bad_job, "The job file contains errors, which 'check' lists, or a case needs more "
                        "memory than the machine has."},
    {ExitCode::some_cases_failed, "Some cases failed: see failed/, then use 'run --retry-failed'. "
                                  "Or files are damaged: rerun 'run'."},
    {ExitCode::environment, "A file, a disk or the environment caused an error. Remove the cause "
                            "and rerun the command."},
    {ExitCode::stopped_early, "The run stopped early. Rerun the command to resume it."},
};

const std::string footer = "A first sweep:\n"
                           "  shearwake check jobs/quickstart.toml\n"
                           "  mpirun -n 2 shearwake run jobs/quickstart.toml\n"
                           "  shearwake reduce out/quickstart && shearwake report out/quickstart\n"
                           "\n";

/// One line for each exit code of the program.
std::string exit_code_list() {
    std::string text = "Exit codes:\n";
    for (const auto& [code, meaning] : exit_codes)
        text += fmt::format("  {:<2}  {}\n", static_cast<int>(code), meaning);
    return text;
}

/// The names of all options of a command and of its unnamed groups, "-S" and "--out".
std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_snames())
            names.push_back("-" + name);
        for (const std::string& name : option->get_lnames())
            names.push_back("--" + name);
    }
    for (const CLI::App* group : command.get_subcommands({}))
        if (group->get_name().empty())
            for (const std::string& name : option_names(*group))
                names.push_back(name);
    return names;
}

/// The command of this name. Throws UsageError with the nearest name when there is none.
const CLI::App* find_command(const CLI::App& app, const std::string& name) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) {
        if (command->check_name(name)) return command;
        names.push_back(command->get_name());
    }
    for (const char* script : {"import-kwave", "make-map", "submit", "nightly"})
        if (name == script)
            throw UsageError(
                fmt::format("{0} is a script: run scripts/{0} in the source folder, or "
                            "shearwake-{0} if the program is installed; --help "
                            "describes it",
                            script));
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

/// Advice on an option that another command has; otherwise empty.
std::string advice_on(const std::string& command, const std::string& option) {
    if (option == "--out" && (command == "plan" || command == "check"))
        return command + " writes no files; give --out to run";
    if (option == "--ranks" && command == "run")
        return "mpirun -n N shearwake run starts the program on N ranks";
    if (option.starts_with("--shard") && command == "run")
        return "runs of the same command in one output folder share its cases, so start the "
               "command "
               "without this option several times, or as a Slurm array of equal tasks";
    return "";
}

/// The message about the first argument that the command does not have, with the nearest option.
std::string unexpected_arguments(const CLI::App& app) {
    const auto selected = app.get_subcommands();
    const CLI::App& command = selected.empty() ? app : *selected.front();
    const std::string name =
        selected.empty() ? "shearwake" : fmt::format("shearwake {}", command.get_name());
    const std::vector<std::string> extra = app.remaining(true);
    const auto option = std::find_if(extra.begin(), extra.end(), [](const std::string& argument) {
        return argument.starts_with('-');
    });
    const std::string hint = fmt::format("{} --help lists the arguments", name);
    if (option == extra.end())
        return fmt::format("unexpected argument: {}; {}", printable(extra.front()), hint);
    const std::string given = option->substr(0, option->find('='));
    if (const std::string advice = advice_on(command.get_name(), given); !advice.empty())
        return fmt::format("unknown option: {}; {}", printable(*option), advice);
    const auto meant = nearest(given, option_names(command));
    return fmt::format("unknown option: {}; {}", printable(*option),
                       meant ? fmt::format("did you mean {}?", *meant) : hint);
}

/// The command that shall print a JSON document; empty: none.
std::string json_command(const CLI::App& app, std::span<char*> arguments) {
    if (arguments.size() < 2) return "";
    const std::string_view wanted = "--json";
    const auto options = arguments.subspan(2);
    if (std::find(options.begin(), options.end(), wanted) == options.end()) return "";
    for (const CLI::App* command : app.get_subcommands({}))
        if (command->check_name(arguments[1]) &&
            command->get_option_no_throw(std::string(wanted)) != nullptr)
            return command->get_name();
    return "";
}

/// Prints a document with the errors that prevent the document of the command.
void print_errors(const std::string& command, const UsageError& error) {
    const auto* bad_job = dynamic_cast<const config::BadJob*>(&error);
    const std::vector<config::Diagnostic> errors =
        bad_job ? bad_job->diagnostics()
                : std::vector<config::Diagnostic>{
                      {.severity = Severity::error, .file = "", .message = error.what()}};
    Json members;
    if (command == "check") // whose documents count the errors
        members = {{"job", ""},
                   {"cases", nullptr},
                   {"errors", errors.size()},
                   {"warnings", 0},
                   {"diagnostics", config::json_of(errors)},
                   {"files", Json::array()}};
    else
        members["errors"] = config::json_of(errors);
    fmt::print("{}", json_document(command, members));
}

/// The arguments of `kwave` with complete names of long options, which users of k-Wave's programs
/// may abbreviate, in the reverse order that CLI11 expects.
std::vector<std::string> arguments_of_kwave(const CLI::App& app, std::span<char*> given) {
    const std::vector<std::string> options = option_names(*find_command(app, "kwave"));
    std::vector<std::string> arguments(given.begin() + 1, given.end());
    for (std::string& argument : arguments) {
        if (!argument.starts_with("--")) continue;
        const std::string name = argument.substr(0, argument.find('='));
        std::vector<std::string> meant;
        std::copy_if(options.begin(), options.end(), std::back_inserter(meant),
                     [&](const std::string& option) { return option.starts_with(name); });
        if (meant.size() == 1) argument = meant[0] + argument.substr(name.size());
    }
    std::reverse(arguments.begin(), arguments.end());
    return arguments;
}

/// Parses the command line and executes its command.
ExitCode execute(CLI::App& app, const Action& action, int argc, char** argv, const Comm& world) {
    // CLI11 would only report that a command is required.
    if (argc > 1 && argv[1][0] != '-') find_command(app, argv[1]);
    const bool is_kwave = argc > 1 && argv[1] == std::string_view("kwave");
    const ExitCode usage = is_kwave ? ExitCode::internal : ExitCode::usage;
    const auto print_usage = [&] { // as k-Wave's programs do
        if (is_kwave && world.is_root())
            fmt::print("{}", find_command(app, "kwave")->help(app.get_name()));
    };
    if (is_kwave) app.name("shearwake"); // CLI11 takes it from argv only
    try {
        if (is_kwave)
            app.parse(arguments_of_kwave(app, {argv, static_cast<std::size_t>(argc)}));
        else
            app.parse(argc, argv);
    } catch (const CLI::ExtrasError&) {
        print_usage();
        throw UsageError(unexpected_arguments(app), usage);
    } catch (const CLI::ParseError& error) {
        const bool is_help = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);
        if (!is_help && !json_command(app, {argv, static_cast<std::size_t>(argc)}).empty())
            throw UsageError(error.what());
        if (!is_help) print_usage();
        if (world.is_root()) app.exit(error);
        return is_help ? ExitCode::done : usage;
    }
    return action(world);
}

/// Names the values in the help: the choices of one_of(), DIR for other text and N for a number,
/// without the ranges and types of CLI11 ("S:NONNEGATIVE").
void name_values(CLI::App& command) {
    for (CLI::Option* option : command.get_options()) {
        std::string choices;
        try {
            for (int i = 0;; ++i) {
                CLI::Validator& validator = *option->get_validator(i);
                if (validator.get_description().starts_with('{'))
                    choices = validator.get_description();
                validator.description("");
            }
        } catch (const CLI::OptionNotFound&) { // after the last one
        }
        const std::string type = option->get_type_name();
        if (!choices.empty())
            option->type_name(choices);
        else if (type == "TEXT")
            option->type_name(option->get_positional() ? "" : "DIR");
        else if (type == "INT" || type == "FLOAT")
            option->type_name("N");
    }
    command.get_formatter()->label("REQUIRED", "");
    for (CLI::App* group : command.get_subcommands({}))
        name_values(*group);
}

/// Reads the command line and calls the function of its command. Collective over the world.
ExitCode program(int argc, char** argv, const Comm& world) {
    Action action;
    CLI::App app("shearwake: parameter sweeps of mid-air ultrasound haptics on viscoelastic skin");
    app.require_subcommand(1);
    app.footer("shearwake --help explains the exit codes."); // of each command
    app.set_version_flag("--version", pipeline::version_text());
#define SHEARWAKE_ADD_COMMAND(name, heading)                                                       \
    add_##name(app, action);                                                                       \
    app.get_subcommand(#name)->group(heading);
    SHEARWAKE_COMMANDS(SHEARWAKE_ADD_COMMAND)
#undef SHEARWAKE_ADD_COMMAND
    add_help(app, action);
    add_text(app, action, "version", "print the version of the program and its libraries",
             [] { return pipeline::version_text() + "\n"; });
    for (const char* name : {"help", "version"})
        app.get_subcommand(name)->group("Reference");
    name_values(app);
    app.footer(footer + exit_code_list());
    app.set_help_all_flag("--help-all", "Print the help of all commands and exit");
    try {
        return execute(app, action, argc, argv, world);
    } catch (const UsageError& error) { // also printed on the standard error
        const std::string command = json_command(app, {argv, static_cast<std::size_t>(argc)});
        if (world.is_root() && !command.empty()) print_errors(command, error);
        throw;
    }
}

/// Only commands that compute need MPI.
MpiUse mpi_use(int argc, char** argv) {
    constexpr std::string_view names[] = {"run",     "optimise", "optimize", "converge",
                                          "fit",     "serve",    "evaluate", "measure",
                                          "respond", "kwave",    "bench",    "lens"};
    const bool computes =
        argc > 1 && std::ranges::find(names, std::string_view(argv[1])) != std::end(names);
    return computes ? MpiUse::always : MpiUse::with_launcher;
}

} // namespace
} // namespace shearwake::app

int main(int argc, char** argv) {
    shearwake::h5::never_tidy_up();
    return shearwake::guarded_main(
        argc, argv, shearwake::app::mpi_use(argc, argv),
        [&](const shearwake::Comm& world) { return shearwake::app::program(argc, argv, world); });
}
