// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"
#include "app/one_case.hpp"

#include "base/json.hpp"
#include "parallel/agree.hpp"
#include "schedule/run/job_source.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/run.hpp"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake::app {
namespace {

/// The values of a row of the table; text cells are id, reference, valid, status and note.
nlohmann::ordered_json values_of(const reduce::Table& table, std::size_t row) {
    nlohmann::ordered_json values = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < table.columns.size(); ++i)
        if (const auto* number = std::get_if<double>(&table.rows[row][i]);
            number && table.columns[i] != "wall_s")
            values[table.columns[i]] = *number;
    return values;
}

std::string cell(const reduce::Table& table, const std::string& column) {
    for (std::size_t i = 0; i < table.columns.size(); ++i)
        if (table.columns[i] == column) return std::get<std::string>(table.rows.front()[i]);
    return "";
}

void print_result(const EvaluateArguments& arguments, const schedule::OutputFolder& folder) {
    const reduce::Table table =
        reduce::table_of({.folder = folder.root, .plan = folder.plan(), .tables = folder.tables()});
    const nlohmann::ordered_json values = values_of(table, 0);
    const std::string id = cell(table, "id");
    if (arguments.json) {
        fmt::print("{}", json_document("evaluate", {{"job", arguments.job.string()},
                                                    {"id", id},
                                                    {"status", cell(table, "status")},
                                                    {"valid", cell(table, "valid") == "yes"},
                                                    {"note", cell(table, "note")},
                                                    {"folder", folder.root.string()},
                                                    {"values", values}}));
        return;
    }
    fmt::print("case {}: {}\n", id, cell(table, "status"));
    for (const auto& [column, value] : values.items())
        if (!std::isnan(value.get<double>()))
            fmt::print("{} = {:.9g}\n", column, value.get<double>());
    fmt::print("results: {}\n", folder.root.string());
    if (const std::string note = cell(table, "note"); !note.empty())
        fmt::print(stderr, "{}\n", note);
}

} // namespace

ExitCode evaluate_command(const EvaluateArguments& arguments, const Comm& world) {
    schedule::RunArguments run;
    run.job = arguments.job;
    run.overrides = one_case_overrides(arguments, world);
    run.quiet = true;
    run.retry_failed = true;
    run.ranks_per_case = world.size();
    const config::Job job = schedule::load_job(arguments.job, run.overrides, world);
    const std::filesystem::path root =
        arguments.out.empty() ? std::filesystem::path("out") / (job.plan.name + ".evaluate")
                              : arguments.out;
    run.out = root / job.plan.cases.front().id;
    const ExitCode code = schedule::run_job(job, run, world);
    if (code != ExitCode::done && code != ExitCode::some_cases_failed) return code;
    on_root(world, [&] { print_result(arguments, {run.out}); });
    return code;
}

} // namespace shearwake::app
