// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "app/common/command.hpp"
#include "base/python_module.hpp"

#include <string>
#include <vector>

namespace shearwake::app {

/// A command that a module of the Python package executes.
struct PythonCommand {
    const char* module;
    const char* rejection; // the message if the module rejects the arguments (exit 2)
    const char* failure;   // the message with another exit code
    /// What precedes the module; returns further arguments for it.
    std::vector<std::string> (*prepare)(const std::vector<std::string>& arguments) =
        [](const std::vector<std::string>&) { return std::vector<std::string>{}; };
    const PythonPackages& packages = figure_packages;
};

/// Declares such a command, to which options can be added. The module receives the arguments and
/// options that are given.
CLI::App& add_python_command(CLI::App& app, Action& action, const std::string& name,
                             const std::string& text, const PythonCommand& command);
/// Adds an argument, or an option with a value, that is passed to the module.
CLI::Option* pass_option(CLI::App& command, const std::string& name, const std::string& text,
                         const std::string& type = "TEXT");
void pass_flag(CLI::App& command, const std::string& name, const std::string& text);

/// Executes such a command. Collective; rank 0 does the work.
ExitCode execute(const PythonCommand& command, const std::vector<std::string>& arguments,
                 const Comm& world);

} // namespace shearwake::app
