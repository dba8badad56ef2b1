// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "app/common/command.hpp"
#include "studies/tables.hpp"

#include <fmt/format.h>

namespace shearwake::app {
namespace {

/// The exit code of a difference is that of `diff` and `cmp`.
constexpr ExitCode differs{1};

/// Tables must be current. Throws UsageError if a path is neither a file nor a folder.
std::vector<std::string> reduce_both(const std::vector<std::string>& arguments) {
    const std::filesystem::path paths[] = {arguments.at(0), arguments.at(1)};
    for (const std::filesystem::path& path : paths) {
        if (!std::filesystem::exists(path))
            throw UsageError(
                fmt::format("{} is neither a case file, a table (CSV) nor an output folder; run "
                            "the job first",
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
        "compare two tables, cases or sweeps, with tolerances; exit 1 if they differ",
        {.module = "shearwake.report.compare",
         .rejection = "the arguments cannot be compared",
         .failure = "the comparison failed",
         .prepare = reduce_both,
         .result = differs});
    command.alias("diff");
    pass_option(command, "A", "output folder, case file (HDF5) or table (CSV)")->required();
    pass_option(command, "B", "reference to compare with: folder, case file or table")->required();
    pass_option(command, "--tolerance",
                "relative tolerance of a column or record (*: of all that are not named), or a "
                "file with tolerances (TOML)",
                "COLUMN=REL|FILE.toml")
        ->take_all();
    pass_option(command, "--page",
                "write a page (HTML) with all differences and a picture of the surfaces that "
                "differ most",
                "FILE");
    pass_flag(command, "--json",
              "print a JSON document instead of text (docs/reference/json-output.md)");
}

} // namespace shearwake::app
