// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

namespace shearwake::serve {

struct ServeArguments {
    double time_limit_s = 60.0; // of a request
    double memory_MB = 2000.0;  // per rank
};

/// Answers requests on the standard input until it ends (docs/reference/serve.md). Collective over
/// the world.
ExitCode serve_command(const ServeArguments& arguments, const Comm& world);

} // namespace shearwake::serve
