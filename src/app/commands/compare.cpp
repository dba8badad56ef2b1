// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "app/common/command.hpp"
#include "studies/tables.hpp"

#include <fmt/format.h>

namespace shearwake::app {
namespace {

/// Tables must be current. Throws UsageError if a path is neither a case file nor a folder.
std::vector<std::string> reduce_both(const std::vector<std::string>& arguments) {
    const std::filesystem::path paths[] = {arguments.at(0), arguments.at(1)};
    for (const std::filesystem::path& path : paths) {
        if (!std::filesystem::exists(path))
            throw UsageError(
                fmt::format("{} is neither a case file nor an output folder; run the job "
                            "first",
                            path.string()),
                ExitCode::environment);
        if (path.extension() == ".toml") schedule::folder_of_results(path); // explains a job file
    }
    for (const std::filesystem::path& path : paths)
        if (std::filesystem::is_directory(path))
            studies::reduce_folder({path}, reduce::ErrorColumns::as_before);
    return {};
}

} // namespace

void add_compare(CLI::App& app, Action& action) {
    CLI::App& command = add_python_command(
        app, action, "compare",
        "compare the fields, traces and columns of two cases or two sweeps, also of "
        "different engines and resolutions",
        {.module = "shearwake.report.compare",
         .rejection = "the arguments cannot be compared",
         .failure = "the comparison failed",
         .prepare = reduce_both});
    pass_option(command, "A", "case file (HDF5) or output folder")->required();
    pass_option(command, "B", "reference: case file or output folder")->required();
    pass_option(command, "--picture",
                "draw the fields and their difference into this file: .png, .svg or .pdf (of "
                "sweeps: the pair that differs most)",
                "FILE");
    pass_flag(command, "--all",
              "list every pair, time, trace and column instead of those that differ most");
    pass_flag(command, "--json", "print the result as JSON");
}

} // namespace shearwake::app
