// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "app/declare_commands.hpp"

namespace shearwake::app {

/// Adds a command that a module of the Python package executes: report, movie, compare, export or
/// explore. The module receives the arguments and options that were given.
void add_python_command(CLI::App& app, Action& action, const std::string& name);

/// Executes such a command. Collective; rank 0 does the work.
ExitCode python_command(const std::string& name, const std::vector<std::string>& arguments,
                        const Comm& world);

} // namespace shearwake::app
