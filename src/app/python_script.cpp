// SPDX-License-Identifier: BSD-3-Clause
#include "app/python_script.hpp"

#include "base/error.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

namespace shearwake::app {
namespace {

/// Exit code of a program run without a shell; -1 if it could not be started.
int run_program(const std::vector<std::string>& command, bool silent) {
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child < 0) return -1;
    if (child == 0) {
        if (silent &&
            (!std::freopen("/dev/null", "w", stdout) || !std::freopen("/dev/null", "w", stderr)))
            ::_exit(127);
        std::vector<char*> argv;
        for (const std::string& word : command)
            argv.push_back(const_cast<char*>(word.c_str()));
        argv.push_back(nullptr);
        ::execvp(argv[0], argv.data());
        ::_exit(127);
    }
    int status = 0;
    if (::waitpid(child, &status, 0) != child) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// The first Python that has the packages which the figures need.
std::string find_python() {
    std::vector<std::string> candidates = {"python3", "/usr/bin/python3"};
    if (const char* chosen = std::getenv("SHEARWAKE_PYTHON"))
        candidates.insert(candidates.begin(), chosen);
    for (const std::string& python : candidates)
        if (run_program({python, "-c", "import numpy, h5py, matplotlib, xxhash"}, true) == 0)
            return python;
    throw UsageError("figures need a Python with numpy, h5py, matplotlib and xxhash (Debian: "
                     "python3-h5py python3-matplotlib python3-xxhash); set SHEARWAKE_PYTHON to "
                     "choose another Python",
                     ExitCode::environment);
}

/// analysis/report next to the build folder, or in share/shearwake next to the folder of an
/// installed program.
std::filesystem::path find_scripts(const std::string& script) {
    const std::filesystem::path here =
        std::filesystem::read_symlink("/proc/self/exe").parent_path();
    for (const std::filesystem::path& candidate :
         {here / "../analysis/report", here / "../share/shearwake/analysis/report"})
        if (std::filesystem::exists(candidate / script))
            return std::filesystem::canonical(candidate);
    throw UsageError(
        fmt::format("cannot find {} in {} or {}", script,
                    (here / "../analysis/report").lexically_normal().string(),
                    (here / "../share/shearwake/analysis/report").lexically_normal().string()),
        ExitCode::environment);
}

} // namespace

int run_python_script(const std::string& script, const std::vector<std::string>& arguments) {
    std::vector<std::string> command = {find_python(), (find_scripts(script) / script).string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return run_program(command, false);
}

} // namespace shearwake::app
