// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "app/common/command.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <unistd.h>

namespace shearwake::app {
namespace {

/// Throws UsageError if no folder exists or can be created at this path, or if nothing can be
/// written there.
void require_output_folder(const std::string& out) {
    namespace fs = std::filesystem;
    if (out.empty()) throw UsageError("--out requires the path of a folder, but is empty");
    if (out.starts_with('-'))
        throw UsageError(fmt::format("--out: {0} begins with \"-\"; write ./{0} for a folder of "
                                     "that name",
                                     out));
    const auto refuse = [&](const std::string& reason) {
        throw UsageError(fmt::format("--out: {} cannot be a folder for results: {}", out, reason));
    };
    if (has_control_characters(out)) refuse("its name contains control characters");
    fs::path at = fs::absolute(out).lexically_normal();
    std::error_code error;
    while (fs::status(at, error).type() == fs::file_type::not_found && at.has_relative_path()) {
        if (fs::is_symlink(fs::symlink_status(at, error)))
            refuse(at.string() + " is a link to a place that does not exist");
        at = at.parent_path();
    }
    if (!fs::is_directory(at, error))
        refuse(error ? error.message() : at.string() + " is not a folder");
    std::string tried = (at / ".shearwake-XXXXXX").string();
    if (!::mkdtemp(tried.data()))
        refuse(fmt::format("{} cannot be written: {}", at.string(), std::strerror(errno)));
    ::rmdir(tried.c_str());
}

std::vector<std::string> prepare_explorer(const std::vector<std::string>& arguments) {
    const std::string option = "--out=";
    for (const std::string& argument : arguments)
        if (argument.starts_with(option)) require_output_folder(argument.substr(option.size()));
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
                            .prepare = prepare_explorer,
                            .packages = explorer_packages});
    pass_option(command, "--port", "port on 127.0.0.1 (default: any free one)", "N")
        ->check(CLI::Range(0, 65535));
    pass_option(command, "--public-port",
                "port to which the browser connects, if another one is forwarded to --port", "N")
        ->check(CLI::Range(0, 65535));
    pass_option(command, "-n,--ranks", "ranks of the engine (default 1)", "N")
        ->check(CLI::Range(1, 1024));
    pass_option(command, "--out", "folder for the sweeps that the page starts (default: out)",
                "DIR");
    pass_flag(command, "--no-browser", "print the address without opening a browser");
}

} // namespace shearwake::app
