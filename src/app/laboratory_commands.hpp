// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "app/declare_commands.hpp"

namespace shearwake::app {

/// Declare the subcommands for scans of a laboratory: export, measure and fit. `app` and `action`
/// must outlive the parsing. Not collective.
void add_laboratory_commands(CLI::App& app, Action& action);

} // namespace shearwake::app
