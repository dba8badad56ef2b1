// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

namespace shearwake::app {

/// Reads the command line and calls the function of its command. Collective over the world.
ExitCode program(int argc, char** argv, const Comm& world);

} // namespace shearwake::app
