// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

#include <cstdio>
#include <filesystem>
#include <unistd.h>

namespace shearwake::serve {

struct ServeArguments {
    double time_limit_s = 60.0;  // of a request
    double memory_MB = 2000.0;   // per rank
    std::filesystem::path files; // folder to which paths in jobs refer; empty: jobs name no files
    int input = STDIN_FILENO;    // of requests, on rank 0
    std::FILE* output = stdout;  // of answers, on rank 0
};

/// Answers requests until the input ends (docs/reference/serve.md). Collective over
/// the world.
ExitCode serve_command(const ServeArguments& arguments, const Comm& world);

} // namespace shearwake::serve
