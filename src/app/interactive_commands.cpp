// SPDX-License-Identifier: BSD-3-Clause
#include "app/interactive_commands.hpp"

#include "app/python_command.hpp"
#include "serve/serve.hpp"

namespace shearwake::app {
namespace {

void add_serve(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<serve::ServeArguments>();
    CLI::App* command = app.add_subcommand(
        "serve", "compute cases on request: reads JSON lines, and keeps transfer functions and "
                 "FFTW plans between them (docs/reference/serve.md)");
    command
        ->add_option("--time-limit", arguments->time_limit_s,
                     "seconds after which a request is ended (default 60)")
        ->type_name("S")
        ->check(CLI::Range(0.001, 1e6));
    command
        ->add_option("--memory", arguments->memory_MB,
                     "memory per rank in MB that a request may use (default 2000)")
        ->type_name("MB")
        ->check(CLI::Range(50.0, 1e9));
    command->callback([=, &action] {
        action = [=](const Comm& world) { return serve::serve_command(*arguments, world); };
    });
}

} // namespace

void add_interactive_commands(CLI::App& app, Action& action) {
    add_serve(app, action);
    add_python_command(app, action, "explore");
}

} // namespace shearwake::app
