// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "app/declare_commands.hpp"

namespace shearwake::app {

/// Declare the subcommands that answer while a user waits: serve and explore. `app` and `action`
/// must outlive the parsing. Not collective.
void add_interactive_commands(CLI::App& app, Action& action);

} // namespace shearwake::app
