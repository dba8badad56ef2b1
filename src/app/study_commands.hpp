// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

#include <CLI/CLI.hpp>
#include <functional>

namespace shearwake::app {

/// Runs the command that the command line names; set by the callback of its subcommand.
using Action = std::function<ExitCode(const Comm&)>;

/// Define the subcommands about accuracy. `app` and `action` must outlive the parsing.
void add_converge(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_reduce(CLI::App& app, Action& action);

} // namespace shearwake::app
