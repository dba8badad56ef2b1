// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "parallel/agree.hpp"
#include "schedule/run/output_folder.hpp"
#include "studies/tables.hpp"

#include <fmt/format.h>

namespace shearwake::app {
namespace {

struct ReduceArguments {
    std::filesystem::path folder;
    bool json = false;
    bool requires_all = false;
    reduce::ErrorColumns errors = reduce::ErrorColumns::omitted;
};

std::string report_line(const std::filesystem::path& folder) {
    return "shearwake report " + schedule::shell_word(folder.string());
}

void print_counts(const reduce::ReducedTables& written, const std::filesystem::path& folder) {
    fmt::print("{}: {} complete, {} failed or missing\n", counted(written.rows, "case"),
               written.complete, written.rows - written.complete);
    if (const std::size_t left = written.rows - written.complete; left > 0 && written.complete > 0)
        fmt::print(stderr,
                   "{} the table is partial: {} of {} cases ha{} no result, and {} empty; "
                   "shearwake status {} lists the reasons\n",
                   coloured("warning:", stderr), left, written.rows, left == 1 ? "s" : "ve",
                   left == 1 ? "its row is" : "their rows are", folder.string());
    if (written.points_to_add > 0)
        fmt::print(stderr, "{} {} of adaptive axes {} not computed yet\n",
                   coloured("warning:", stderr), counted(written.points_to_add, "point"),
                   written.points_to_add == 1 ? "is" : "are");
    if (written.not_valid > 0)
        fmt::print("the readings of {} are not valid: see the column note\n",
                   counted(written.not_valid, "case"));
    if (written.programs.size() > 1)
        fmt::print("{} {} versions of the program computed the cases: {}\n",
                   coloured("warning:", stdout),
                   written.programs.size() == 2 ? "two" : std::to_string(written.programs.size()),
                   fmt::join(written.programs, ", "));
}

void print_damaged(const reduce::ReducedTables& written) {
    if (!written.damaged.empty())
        fmt::print(stderr,
                   "{} {}: {}; the rows of these cases are empty, the next run computes them "
                   "again\n",
                   coloured("error:", stderr), counted(written.damaged.size(), "damaged case file"),
                   fmt::join(written.damaged, ", "));
}

void print_files(const reduce::ReducedTables& written, const std::filesystem::path& folder) {
    fmt::print("{}", written.first_rows);
    fmt::print("table: {}\n       {}\n", written.csv.string(), written.markdown.string());
    for (const auto& file : {written.statistics, written.sensitivity, written.adaptive})
        if (!file.empty()) fmt::print("       {}\n", file.string());
    fmt::print("next: {}\n", report_line(folder));
}

void print_json(const reduce::ReducedTables& written, const std::filesystem::path& folder) {
    const auto path = [](const std::filesystem::path& file) {
        return file.empty() ? Json() : Json(file.string());
    };
    fmt::print("{}", json_document("reduce", {{"folder", folder.string()},
                                              {"cases", written.rows},
                                              {"complete", written.complete},
                                              {"not_valid", written.not_valid},
                                              {"damaged", written.damaged},
                                              {"programs", written.programs},
                                              {"csv", path(written.csv)},
                                              {"markdown", path(written.markdown)},
                                              {"statistics", path(written.statistics)},
                                              {"sensitivity", path(written.sensitivity)},
                                              {"adaptive", path(written.adaptive)},
                                              {"next", report_line(folder)}}));
}

ExitCode reduce_command(const ReduceArguments& arguments, const Comm& world) {
    const std::filesystem::path& path = arguments.folder;
    bool is_partial = false;
    on_root(world, [&] {
        const reduce::ReducedTables written =
            studies::reduce_folder(schedule::folder_of_results(path), arguments.errors);
        is_partial = !written.damaged.empty() ||
                     (arguments.requires_all &&
                      (written.complete < written.rows || written.points_to_add > 0));
        if (!arguments.json) print_counts(written, path);
        print_damaged(written);
        if (written.complete == 0)
            throw UsageError(fmt::format("no case of {} is complete, so there is nothing to "
                                         "reduce; shearwake status {} lists the reasons",
                                         path.string(), path.string()),
                             ExitCode::some_cases_failed);
        if (arguments.json)
            print_json(written, path);
        else
            print_files(written, path);
    });
    return world.broadcast(is_partial) ? ExitCode::some_cases_failed : ExitCode::done;
}

} // namespace

void add_reduce(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<ReduceArguments>(
        app, action, "reduce", "write tables (CSV, Markdown) from the case files", reduce_command);
    command.add_option("DIR", arguments.folder, "output folder of a run")->required();
    command.add_flag_callback(
        "--errors", [&errors = arguments.errors] { errors = reduce::ErrorColumns::added; },
        "add columns <column>_error with the errors that shearwake converge estimated");
    command.add_flag("--complete", arguments.requires_all,
                     "exit with 4 if a case has no result; the tables are written nevertheless");
    add_json(command, arguments.json);
}

} // namespace shearwake::app
