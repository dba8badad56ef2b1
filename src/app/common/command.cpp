// SPDX-License-Identifier: BSD-3-Clause
#include "app/common/command.hpp"

#include "base/text.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>

namespace shearwake::app {
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
    add_value(command, "--walltime", arguments.walltime, "S|H:MM:SS|D-HH:MM",
              "start no case that cannot finish within this time (default: the limit of the "
              "Slurm job)");
    add_value(command, "--log-json", arguments.log_json, "FILE",
              "append progress to this file as lines of JSON");
    command.add_flag("--allow-mixed", arguments.allow_mixed,
                     "continue in a folder with results of another version of the program");
    command.add_flag("--retry-failed", arguments.retry_failed, "try failed cases again");
    command.add_flag("--force", arguments.force,
                     "run although the estimates exceed the memory, the disk or the time limit");
    command.add_flag("--quiet", arguments.quiet, "print only errors");
    command.add_flag("--verbose", arguments.verbose,
                     "print the choices of the engine for each case, as `show` does");
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

namespace {

/// Arguments first, then options as --name=value, or those of one letter as -S value.
std::vector<std::string> given_arguments(const CLI::App& command) {
    std::vector<std::string> arguments, options;
    for (const CLI::Option* option : command.get_options()) {
        if (option->count() == 0) continue;
        const std::string value = fmt::format("{}", fmt::join(option->results(), ","));
        if (option->get_lnames().empty()) {
            for (const std::string& name : option->get_snames())
                for (const std::string& result : option->results())
                    options.insert(options.end(), {"-" + name, result});
            if (option->get_snames().empty()) arguments.push_back(value);
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

CLI::App& add_python_command(CLI::App& app, Action& action, const std::string& name,
                             const std::string& text, const PythonCommand& command) {
    CLI::App* declared = app.add_subcommand(name, text);
    declared->callback([=, &action] {
        action = [=](const Comm& world) {
            return command.execute(command, given_arguments(*declared), world);
        };
    });
    return *declared;
}

CLI::Option* pass_option(CLI::App& command, const std::string& name, const std::string& text,
                         const std::string& type) {
    return command.add_option(name)->description(text)->type_name(type);
}

void pass_flag(CLI::App& command, const std::string& name, const std::string& text) {
    command.add_flag(name)->description(text);
}

ExitCode execute(const PythonCommand& command, const std::vector<std::string>& arguments,
                 const Comm& world) {
    ExitCode code = ExitCode::done; // of rank 0; the program exits with the largest of all ranks
    on_root(world, [&] {
        const std::vector<std::string> more = command.prepare(arguments);
        std::vector<std::string> all = arguments;
        all.insert(all.end(), more.begin(), more.end());
        const bool captures = std::ranges::find(arguments, "--json") != arguments.end();
        std::string messages;
        const int status = run_python_module(command.module, all, command.packages,
                                             captures ? &messages : nullptr);
        const std::string error = error_in(messages);
        if (error.empty()) fmt::print(stderr, "{}", messages);
        if (status == static_cast<int>(command.result))
            code = command.result;
        else if (status == static_cast<int>(ExitCode::usage))
            throw UsageError(error.empty() ? command.rejection : error);
        else if (status != 0)
            throw UsageError(error.empty() ? fmt::format("{} (exit {})", command.failure, status)
                                           : error,
                             ExitCode::environment);
    });
    return code;
}

} // namespace shearwake::app
