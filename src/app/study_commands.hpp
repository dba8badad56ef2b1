// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "app/declare_commands.hpp"

namespace shearwake::app {

/// Define the subcommands about accuracy. `app` and `action` must outlive the parsing.
void add_converge(CLI::App& app, Action& action);
void add_optimise(CLI::App& app, Action& action);
void add_reduce(CLI::App& app, Action& action);

} // namespace shearwake::app
