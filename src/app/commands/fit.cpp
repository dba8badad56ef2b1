// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "parallel/agree.hpp"
#include "serve/serve.hpp"

#include <cstdio>
#include <optional>

namespace shearwake::app {
namespace {

constexpr double unlimited = 1e9; // s, MB

/// Computes what the module requests, on all ranks. It prints its own messages, and its exit code
/// is that of the command. Collective.
ExitCode execute_fit(const PythonCommand& command, const std::vector<std::string>& arguments,
                     const Comm& world) {
    std::optional<PythonClient> client;
    std::FILE* answers = stdout;
    on_root(world, [&] {
        client.emplace(command.module, arguments, command.packages);
        answers = client->open_answers();
    });
    PythonClient::interrupt_by_signals();
    const std::filesystem::path job = std::filesystem::absolute(arguments.front());
    serve::serve_command({.time_limit_s = unlimited,
                          .memory_MB = unlimited,
                          .files = job.parent_path(),
                          .input = client ? client->requests() : -1,
                          .output = answers},
                         world);
    int status = 0;
    on_root(world, [&] {
        std::fclose(answers);
        status = client->exit_code();
        if (status < 0) throw UsageError(command.failure, ExitCode::environment);
    });
    return static_cast<ExitCode>(status);
}

} // namespace

void add_fit(CLI::App& app, Action& action) {
    CLI::App& command = add_python_command(
        app, action, "fit", "estimate the keys of [uncertain] of a job from a measured scan",
        {.module = "shearwake.studies.fitting",
         .rejection = "",
         .failure = "the fit was ended by a signal",
         .packages = scan_packages,
         .execute = execute_fit});
    pass_option(command, "JOB",
                "job file (TOML); the distributions of [uncertain] are bounds and priors")
        ->required();
    pass_option(command, "--data", scan_texts::data, "DATA")->required();
    pass_option(command, "-S", "override a key of the job: -S load.peak_Pa=200", "KEY=VALUE")
        ->take_all();
    pass_option(command, "--least-quality", scan_texts::least_quality, "Q")
        ->check(CLI::Range(0.0, 1.0));
    pass_flag(command, "--outwards", scan_texts::outwards);
    pass_option(command, "--out", scan_texts::out, "DIR");
}

} // namespace shearwake::app
