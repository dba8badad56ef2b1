// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "serve/serve.hpp"

namespace shearwake::app {

void add_serve(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<serve::ServeArguments>(
        app, action, "serve",
        "compute cases on request: reads JSON lines, and keeps transfer functions and "
        "FFTW plans between them (docs/reference/serve.md)",
        serve::serve_command);
    add_value(command, "--time-limit", arguments.time_limit_s, "S",
              "seconds after which a request is ended (default 60)")
        ->check(CLI::Range(0.001, 1e6));
    add_value(command, "--memory", arguments.memory_MB, "MB",
              "memory per rank in MB that a request may use (default 2000)")
        ->check(CLI::Range(50.0, 1e9));
    add_value(
        command, "--files", arguments.files, "DIR",
        "allow jobs to refer to text files, whose paths are relative to this folder (default: "
        "jobs cannot refer to files)")
        ->check(CLI::ExistingDirectory);
}

} // namespace shearwake::app
