// SPDX-License-Identifier: BSD-3-Clause
#include "studies/converge/convergence.hpp"

#include "base/python_module.hpp"
#include "parallel/agree.hpp"
#include "schedule/run/run.hpp"
#include "schedule/run/output_folder.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/files.hpp"
#include "storage/journal/plan_file.hpp"
#include "storage/journal/claims.hpp"
#include "studies/tables.hpp"

#include <fmt/format.h>
#include <optional>

namespace shearwake::converge {
namespace {

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

std::string command_line(const ConvergeArguments& arguments) {
    return schedule::command_line("converge", arguments) +
           (arguments.only.empty() ? fmt::format(" --cases {}", arguments.cases) : "");
}

/// Estimates the errors from the table of the refined cases.
void estimate_errors(const RefinedPlan& refined, const schedule::OutputFolder& sweep,
                     const schedule::OutputFolder& study, bool quiet) {
    studies::reduce_folder(study, reduce::ErrorColumns::omitted);
    storage::write_file(study.root / "refinements.json", storage::seal(json_text(refined)));
    std::vector<std::string> arguments = {sweep.root.string()};
    if (quiet) arguments.emplace_back("--quiet");
    if (run_python_module("shearwake.studies.convergence", arguments, table_packages) != 0)
        throw UsageError("the errors were not estimated", ExitCode::environment);
    if (!quiet)
        fmt::print("next: shearwake reduce --errors {} adds the errors to the table, and shearwake "
                   "report draws them\n",
                   schedule::shell_word(sweep.root.string()));
}

} // namespace

ExitCode converge_job(const ConvergeArguments& arguments, const Comm& world) {
    config::Job job = schedule::load_job(arguments.job, arguments.overrides, world);
    const schedule::OutputFolder sweep = schedule::output_folder(arguments.out, job.plan.name);
    const schedule::OutputFolder study{sweep.converge()};
    const Plan plan = job.plan; // the studied cases refer to it
    const RefinedPlan refined = refined_plan(plan, arguments.only, arguments.cases);
    job.plan = refined.plan;
    job.diagnostics.clear();                     // `run` reports them
    std::optional<storage::FileLock> study_lock; // on rank 0
    on_root(world, [&] {
        require_python(table_packages); // before anything is computed
        storage::make_directory(study.locks());
        if (study_lock.emplace(study.locks() / "study").is_refused())
            throw UsageError(fmt::format("{} is being used by another shearwake converge; wait for "
                                         "it or stop it",
                                         study.root.string()));
        schedule::remove_other_plan(study, job.plan);
        copy_known_cases(sweep, study, job.plan);
    });
    schedule::RunArguments run{arguments};
    run.out = study.root;
    run.only.clear();
    run.resumed_by = command_line(arguments);
    const ExitCode code = schedule::run_job(job, run, world);
    if (code == ExitCode::stopped_early) return code;
    on_root(world, [&] { estimate_errors(refined, sweep, study, arguments.quiet); });
    return code;
}

} // namespace shearwake::converge
