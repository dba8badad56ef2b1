// SPDX-License-Identifier: BSD-3-Clause
#include "studies/converge/convergence.hpp"

#include "measures/measure_table.hpp"
#include "parallel/agree.hpp"
#include "schedule/run/run.hpp"
#include "schedule/run/output_folder.hpp"
#include "storage/files.hpp"
#include "storage/journal/plan_file.hpp"
#include "storage/journal/claims.hpp"
#include "studies/tables.hpp"

#include <fmt/format.h>
#include <map>
#include <set>

namespace shearwake::converge {
namespace {

/// The columns of the complete cases in the table of the study.
std::map<std::string, Values> values_in(const reduce::Table& table, std::size_t swept_keys) {
    const std::size_t first = 2 + swept_keys, status = table.columns.size() - 2,
                      end = table.columns.size() - reduce::closing_columns;
    std::map<std::string, Values> values;
    for (const auto& row : table.rows) {
        if (std::get<std::string>(row[status]) != "complete") continue;
        Values& found = values[std::get<std::string>(row[0])];
        for (std::size_t i = first; i < end; ++i)
            found[table.columns[i]] = std::get<double>(row[i]);
    }
    return values;
}

/// Complete cases of the sweep that the study contains are not computed again.
void copy_known_cases(const schedule::OutputFolder& sweep, const schedule::OutputFolder& study,
                      const Plan& plan) {
    namespace fs = std::filesystem;
    if (!fs::exists(sweep.cases())) return;
    storage::CaseIndex index(sweep.root);
    storage::make_directory(study.cases());
    for (const PlannedCase& c : plan.cases) {
        if (fs::exists(study.case_file(c.id)) || !index.is_complete(c.id)) continue;
        const fs::path part = storage::part_path(study.cases() / (c.id + ".copy"));
        fs::copy_file(sweep.case_file(c.id), part, fs::copy_options::overwrite_existing);
        storage::publish(part, study.case_file(c.id));
    }
}

std::vector<std::string> headlines() {
    std::vector<std::string> names;
    for (const measures::Measure& measure : measures::all_measures())
        if (measure.shown == measures::Shown::headlines && !measures::counts_samples(measure.name))
            names.emplace_back(measure.name);
    return names;
}

std::string command_line(const ConvergeArguments& arguments) {
    return schedule::command_line("converge", arguments) +
           (arguments.only.empty() ? fmt::format(" --cases {}", arguments.cases) : "");
}

/// The columns of the table that the study does not cover.
std::string omitted_text(const std::vector<CaseChange>& changes,
                         const std::map<std::string, Values>& values) {
    std::set<std::string> omitted;
    for (const auto& [id, row] : values)
        for (const auto& [column, value] : row)
            omitted.insert(column);
    for (const CaseChange& c : changes)
        for (const ColumnChange& column : c.columns)
            omitted.erase(column.column);
    if (omitted.empty()) return "";
    return fmt::format(
        "\ncolumns without an estimate, which are empty, count samples or are the largest "
        "of all samples: {}\n",
        fmt::join(omitted, ", "));
}

/// Writes the result and returns it as text.
std::string finish(const std::string& name, const RefinedPlan& refined,
                   const schedule::OutputFolder& sweep, const schedule::OutputFolder& study) {
    const reduce::Table computed = studies::table_of(study);
    const auto values = values_in(computed, refined.plan.swept_keys.size());
    auto changes = changes_of(refined, values);
    for (CaseChange& change : changes)
        for (const auto& row : computed.rows)
            if (row[0] == reduce::Cell(change.studied->base_id))
                change.is_valid = row[row.size() - reduce::closing_columns] != reduce::Cell("no");
    const std::string text = markdown_text(changes, headlines()) + omitted_text(changes, values);
    const std::filesystem::path table = study.root / "converge.md";
    storage::write_file(sweep.errors(), json_text(name, changes));
    storage::write_file(table, "# " + refined.plan.title + "\n\n" + text);
    return fmt::format(
        "\n{}\nconvergence: {}\n             {}\nnext: shearwake reduce --errors {} adds "
        "the errors to the table, and shearwake report draws them\n",
        text, sweep.errors().string(), table.string(), schedule::shell_word(sweep.root.string()));
}

} // namespace

ExitCode converge_job(const ConvergeArguments& arguments, const Comm& world) {
    config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    const schedule::OutputFolder sweep = schedule::output_folder(arguments.out, job.plan.name);
    const schedule::OutputFolder study{sweep.converge()};
    const Plan plan = job.plan; // the studied cases refer to it
    const RefinedPlan refined = refined_plan(plan, arguments.only, arguments.cases);
    job.plan = refined.plan;
    job.diagnostics.clear(); // `run` reports them
    on_root(world, [&] {
        storage::make_directory(study.locks());
        const storage::FolderLock lock(study.locks(), std::chrono::minutes(1));
        // Another selection replaces the plan; the cases that both have remain.
        if (std::filesystem::exists(study.plan()) &&
            storage::compare_plan(storage::read_file(study.plan()), job.plan) !=
                storage::PlanMatch::same) {
            storage::require_no_run(study.locks());
            std::filesystem::remove(study.plan());
        }
        copy_known_cases(sweep, study, job.plan);
    });
    schedule::RunArguments run{arguments};
    run.out = study.root;
    run.only.clear();
    run.resumed_by = command_line(arguments);
    const ExitCode code = schedule::run_job(job, run, world);
    if (code == ExitCode::stopped_early) return code;
    on_root(world, [&] {
        const std::string text = finish(plan.name, refined, sweep, study);
        if (!arguments.quiet) fmt::print("{}", text);
    });
    return code;
}

} // namespace shearwake::converge
