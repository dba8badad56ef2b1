// SPDX-License-Identifier: BSD-3-Clause
#include "app/common/python_command.hpp"

#include "parallel/agree.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace shearwake::app {
namespace {

/// Arguments first, then options as --name=value.
std::vector<std::string> given_arguments(const CLI::App& command) {
    std::vector<std::string> arguments, options;
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

CLI::App& add_python_command(CLI::App& app, Action& action, const std::string& name,
                             const std::string& text, const PythonCommand& command) {
    CLI::App* declared = app.add_subcommand(name, text);
    declared->callback([=, &action] {
        action = [=](const Comm& world) {
            return execute(command, given_arguments(*declared), world);
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
        if (status == static_cast<int>(ExitCode::some_cases_failed))
            code = ExitCode::some_cases_failed;
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
