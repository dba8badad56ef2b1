// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "parallel/agree.hpp"
#include "studies/tables.hpp"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace shearwake::app {
namespace {

struct EvaluateArguments : schedule::JobArguments {
    std::filesystem::path out; // empty: out/<job name>.evaluate
    bool json = false;
};

/// The values of a row of the table; text cells are id, reference, valid, status and note.
Json values_of(const reduce::Table& table, std::size_t row) {
    Json values = Json::object();
    for (std::size_t i = 0; i < table.columns.size(); ++i)
        if (const auto* number = std::get_if<double>(&table.rows[row][i]);
            number && table.columns[i] != "wall_s")
            values[table.columns[i]] = *number;
    return values;
}

std::string cell(const reduce::Table& table, const std::string& column) {
    const auto place = table.find(column);
    return place ? std::get<std::string>(table.rows.front()[*place]) : "";
}

void print_result(const EvaluateArguments& arguments, const schedule::OutputFolder& folder) {
    const reduce::Table table = studies::table_of(folder);
    const Json values = values_of(table, 0);
    const std::string id = cell(table, "id"),
                      note = fmt::format("{}", fmt::join(table.note(0), "; "));
    if (arguments.json) {
        fmt::print("{}", json_document("evaluate", {{"job", arguments.job.string()},
                                                    {"id", id},
                                                    {"status", cell(table, "status")},
                                                    {"valid", cell(table, "valid") == "yes"},
                                                    {"note", note},
                                                    {"folder", folder.root.string()},
                                                    {"values", values}}));
        return;
    }
    fmt::print("case {}: {}\n", id, cell(table, "status"));
    for (const auto& [column, value] : values.items())
        if (!std::isnan(value.get<double>()))
            fmt::print("{} = {:.9g}\n", column, value.get<double>());
    fmt::print("results: {}\n", folder.root.string());
    if (!note.empty()) fmt::print(stderr, "{}\n", coloured(note, stderr));
}

ExitCode evaluate_command(const EvaluateArguments& arguments, const Comm& world) {
    const studies::Evaluation evaluation = studies::evaluate(arguments, arguments.out, world);
    const bool has_result =
        evaluation.code == ExitCode::done || evaluation.code == ExitCode::some_cases_failed;
    if (has_result) on_root(world, [&] { print_result(arguments, evaluation.folder); });
    return evaluation.code;
}

} // namespace

void add_evaluate(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<EvaluateArguments>(
        app, action, "evaluate",
        "compute one case of a job, without its sweep, and print its measures", evaluate_command);
    command.add_option("JOB", arguments.job, "job file (TOML)")->required();
    add_overrides(command, arguments.overrides,
                  "set a key of the job: --set medium.layer[1].c_s_m_s=4.5", "--set,-S");
    command.add_option("--out", arguments.out,
                       "folder of the evaluated cases (default: out/<job name>.evaluate); a case "
                       "that it contains is not computed again");
    add_json(command, arguments.json);
}

} // namespace shearwake::app
