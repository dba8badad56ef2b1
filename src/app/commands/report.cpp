// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "app/common/python_command.hpp"
#include "studies/tables.hpp"

namespace shearwake::app {
namespace {

std::vector<std::string> reduce_first(const std::vector<std::string>& arguments) {
    studies::reduce_folder(schedule::folder_of_results(arguments.front()),
                           reduce::ErrorColumns::as_before);
    return {};
}

constexpr PythonCommand report{.module = "shearwake.report",
                               .rejection = "no report was written",
                               .failure = "the report failed",
                               .prepare = reduce_first};

} // namespace

void add_report(CLI::App& app, Action& action) {
    CLI::App& command =
        add_python_command(app, action, "report", "draw figures and write one HTML page", report);
    pass_option(command, "DIR", "output folder of a run")->required();
    pass_option(command, "--only",
                "where not all cases can be drawn, draw these, by id, and their references",
                "ID[,ID]")
        ->take_all();
    pass_flag(command, "--json",
              "print a JSON document instead of text (docs/reference/json-output.md)");
}

ExitCode draw_report(const std::filesystem::path& folder, const Comm& world) {
    return execute(report, {folder.string()}, world);
}

} // namespace shearwake::app
