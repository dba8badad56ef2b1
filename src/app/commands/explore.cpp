// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "app/common/python_command.hpp"

namespace shearwake::app {
namespace {

std::vector<std::string> program_path(const std::vector<std::string>&) {
    return {"--program=" + std::filesystem::read_symlink("/proc/self/exe").string()};
}

} // namespace

void add_explore(CLI::App& app, Action& action) {
    CLI::App& command =
        add_python_command(app, action, "explore",
                           "open a page in the browser that computes while settings are changed",
                           {.module = "shearwake.explore",
                            .rejection = "the page ended with an error",
                            .failure = "the page ended with an error",
                            .prepare = program_path,
                            .packages = explorer_packages});
    pass_option(command, "--port", "port on 127.0.0.1 (default: any free one)", "N")
        ->check(CLI::Range(0, 65535));
    pass_option(command, "-n,--ranks", "ranks of the engine (default 1)", "N")
        ->check(CLI::Range(1, 1024));
    pass_option(command, "--out", "folder for the sweeps that the page starts (default: out)",
                "DIR");
    pass_flag(command, "--no-browser", "print the address without opening a browser");
}

} // namespace shearwake::app
