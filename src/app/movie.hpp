// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "app/declare_commands.hpp"

namespace shearwake::app {

/// Adds the command `movie`, which writes the recorded surfaces of a case as MP4 and GIF, and sets
/// `action` if it is selected. The action is collective; rank 0 does the work.
void add_movie(CLI::App& app, Action& action);

} // namespace shearwake::app
