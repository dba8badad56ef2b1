// SPDX-License-Identifier: BSD-3-Clause
#include "studies/tables.hpp"

#include "base/python_module.hpp"
#include "base/text.hpp"
#include "config/document/tree.hpp"
#include "parallel/agree.hpp"
#include "schedule/run/run.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::studies {

namespace {

/// The reference of the job as the table [table] of a job without axes.
std::string table_without_axes(const std::filesystem::path& job) {
    config::DiagnosticList ignored; // load_job() reports errors
    const config::NodePtr tree = config::parse_toml(
        storage::read_file(job, storage::largest_user_text_B), job.string(), ignored);
    const config::NodePtr reference =
        tree ? config::find(tree, {{"table"}, {"reference"}}) : nullptr;
    return reference ? fmt::format("{{ reference = {} }}", config::render(*reference)) : "{}";
}

} // namespace

std::vector<std::string> one_case_overrides(const std::vector<std::string>& overrides,
                                            const std::string& table) {
    for (const std::string& text : overrides)
        if ((text.starts_with("sweep") && text != "sweep={}") ||
            (text.starts_with("uncertain") && text != "uncertain={}"))
            throw UsageError(
                fmt::format("-S {}: this command uses one case; set the key itself, as "
                            "in -S load.peak_Pa=200",
                            printable(text)));
    std::vector<std::string> all = {"sweep={}", "uncertain={}", "table=" + table};
    all.insert(all.end(), overrides.begin(), overrides.end());
    return all;
}

Evaluation evaluate(const schedule::JobArguments& arguments, const std::filesystem::path& out,
                    const Comm& world) {
    std::string table;
    on_root(world, [&] { table = table_without_axes(arguments.job); });
    schedule::RunArguments run;
    run.job = arguments.job;
    run.overrides = one_case_overrides(arguments.overrides, world.broadcast(std::move(table)));
    run.quiet = true;
    run.retry_failed = true;
    run.ranks_per_case = world.size();
    const config::Job job = schedule::load_job(arguments.job, run.overrides, world);
    run.out =
        schedule::output_folder(out, job.plan.name + ".evaluate").root / job.plan.cases.front().id;
    return {schedule::run_job(job, run, world), {run.out}};
}

namespace {

bool contains_cases(const schedule::OutputFolder& folder) {
    namespace fs = std::filesystem;
    if (!fs::is_directory(folder.cases())) return false;
    const fs::directory_iterator files(folder.cases());
    return std::any_of(fs::begin(files), fs::end(files), [](const auto& entry) {
        return !storage::id_of_file(entry.path()).empty();
    });
}

/// The path of plan.json or, without it, of tables/plan.json, which is made from the case files.
std::filesystem::path plan_of(const schedule::OutputFolder& folder) {
    if (std::filesystem::exists(folder.plan()) || !contains_cases(folder)) return folder.plan();
    if (run_python_module("shearwake.from_cases", {folder.root.string()}) != 0)
        throw UsageError("cannot reconstruct the plan from the case files in " +
                             folder.cases().string(),
                         ExitCode::environment);
    return folder.tables() / "plan.json";
}

} // namespace

reduce::Table table_of(const schedule::OutputFolder& folder) {
    return reduce::table_of(
        {.folder = folder.root, .plan = folder.plan(), .tables = folder.tables()});
}

reduce::ReducedTables reduce_folder(const schedule::OutputFolder& folder,
                                    reduce::ErrorColumns errors) {
    reduce::ReduceInput input{.folder = folder.root,
                              .plan = plan_of(folder),
                              .tables = folder.tables(),
                              .errors = folder.errors(),
                              .error_columns = errors};
    if (std::filesystem::exists(folder.uncertainty())) {
        input.errors = folder.uncertainty();
        input.meaning_of_errors = "standard deviation over repetitions with noise and gaps";
    }
    return reduce::reduce(input);
}

} // namespace shearwake::studies
