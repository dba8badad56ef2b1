// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"

#include "app/python_script.hpp"
#include "parallel/agree.hpp"

#include <fmt/format.h>

namespace shearwake::app {

ExitCode explore_command(const ExploreArguments& arguments, const Comm& world) {
    on_root(world, [&] {
        std::vector<std::string> words = {
            "--program", std::filesystem::read_symlink("/proc/self/exe").string(),
            "--port",    fmt::format("{}", arguments.port),
            "--ranks",   fmt::format("{}", arguments.ranks),
            "--out",     arguments.folder.empty() ? "out" : arguments.folder.string()};
        if (!arguments.opens_browser) words.push_back("--no-browser");
        const int status = run_python_script("explore/explore.py", words, explorer_packages);
        if (status != 0)
            throw UsageError(fmt::format("the page ended with an error (exit {})", status),
                             ExitCode::environment);
    });
    return ExitCode::done;
}

} // namespace shearwake::app
