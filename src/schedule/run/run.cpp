// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/run.hpp"

#include "base/cache.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "engines/registry/make_engine.hpp"
#include "parallel/agree.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/cost/case_costs.hpp"
#include "schedule/cost/rates.hpp"
#include "schedule/run/arrangement.hpp"
#include "schedule/run/closing_message.hpp"
#include "schedule/run/deadline.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/progress.hpp"
#include "schedule/run/select_cases.hpp"
#include "schedule/run/worker.hpp"
#include "simd/instruction_set.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/claims.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <functional>
#include <optional>
#include <unistd.h>
#include <vector>

namespace shearwake::schedule {

namespace {

std::string warnings_of(const config::Job& job) {
    std::string all;
    for (const config::Diagnostic& diagnostic : job.diagnostics)
        all += config::text(diagnostic) + "\n";
    return all;
}

/// The state of the sweep at the start of the run.
struct Beginning {
    Selection selection;
    storage::JournalContents journal;
    std::vector<SetAside> damaged; // on rank 0 only, like the warning
    std::string warning;
};

/// Whether the folder contains complete cases of another version of the program. Throws UsageError
/// if this is not allowed.
bool is_mixed(const Plan& plan, storage::CaseIndex& index, const RunArguments& arguments) {
    for (const PlannedCase& c : plan.cases) {
        const storage::CaseDigest* digest = index.find(c.id);
        if (!digest || !digest->is_complete() || digest->git_id == pipeline::program_git_id())
            continue;
        if (arguments.allow_mixed) return true;
        throw UsageError(fmt::format(
            "case {} was computed by another version of this program, {}; this one is {}. Choose "
            "another folder with --out, or use --allow-mixed to mix the results; case files and "
            "the journal record the versions",
            digest->id, digest->git_id, pipeline::program_git_id()));
    }
    return false;
}

/// Prepares the folder and reads its state, on rank 0. `active` shows the run to others until its
/// end.
Beginning begin_run(const config::Job& job, const OutputFolder& folder,
                    const RunArguments& arguments, std::optional<storage::ActiveRun>& active,
                    storage::RunStart& start) {
    const std::string warning =
        prepare_output(folder, job, arguments.extend ? OtherPlan::replaced : OtherPlan::refused);
    active.emplace(folder.locks());
    storage::CaseIndex index(folder.root);
    storage::CaseClaims claims(folder.locks(), start.run);
    Beginning beginning{.selection = {},
                        .journal = storage::read_journals(folder.root),
                        .damaged = {},
                        .warning = warning};
    beginning.selection = select_cases(job.plan, beginning.journal, index, arguments);
    start.allow_mixed = is_mixed(job.plan, index, arguments);
    beginning.damaged =
        set_damaged_aside(folder, job.plan, beginning.selection.work, claims, index);
    remove_left_over(folder, claims, index);
    index.save();
    return beginning;
}

/// Throws UsageError if the folder or case files have been removed during the run, so that the
/// sweep is not reported as complete. Not collective.
void require_files(const OutputFolder& folder, const Plan& plan,
                   const std::vector<std::size_t>& there, const WorkResult& result) {
    if (result.folder_removed || folder.has_lost_plan())
        throw UsageError(
            fmt::format("the output folder {} was removed during the run (plan.json is "
                        "missing): the run has stopped; rerun the command to start "
                        "from scratch",
                        folder.root.string()),
            ExitCode::environment);
    std::vector<std::string> lost;
    for (const auto* numbers : {&there, &result.computed})
        for (const std::size_t number : *numbers) {
            const std::string& id = plan.cases[number].id;
            std::error_code error;
            const bool is_there = std::filesystem::exists(folder.case_file(id), error);
            if (!is_there && !error) lost.push_back(id);
        }
    if (lost.empty()) return;
    throw UsageError(fmt::format("{} case files were removed from {} during the run, the first is "
                                 "{}.h5; rerun the command to compute them again",
                                 lost.size(), folder.cases().string(), lost.front()),
                     ExitCode::environment);
}

/// Whether the remaining cases are left for a later run. A requested stop has priority over
/// failures; otherwise failures of files and --fail-fast determine the exit code.
bool was_stopped(const WorkResult& result) {
    if (result.asked_to_stop) return true;
    return result.postponed > 0 && !result.given_up;
}

bool is_stopped(const WorkResult& result, const Selection& selection) {
    const bool all_ended =
        result.failed + result.done + result.elsewhere == static_cast<long>(selection.work.size());
    return !all_ended && was_stopped(result);
}

ExitCode code_of(const WorkResult& result, const Selection& selection) {
    if (is_stopped(result, selection)) return ExitCode::stopped_early;
    if (result.failed_files > 0) return ExitCode::environment;
    return result.failed + selection.failed_before > 0 ? ExitCode::some_cases_failed
                                                       : ExitCode::done;
}

/// Records the end of the run, prints the closing message or document on rank 0, unless `document`
/// stores it, and returns the exit code.
/// Collective.
ExitCode concluded(const OutputFolder& folder, const config::Job& job, const Selection& selection,
                   const WorkResult& result, const RunArguments& arguments, const Comm& world,
                   const std::string& run, Json* document) {
    const ExitCode code = code_of(result, selection);
    const char* how = code == ExitCode::stopped_early ? "stopped"
                      : result.failed > 0             ? "with failures"
                                                      : "done";
    const Ending ending = code == ExitCode::stopped_early ? Ending::stopped : Ending::regular;
    on_root(world, [&] {
        storage::Journal(folder.journal(run)).run_ended(how);
        if (arguments.json) {
            const Json members =
                closing_document(folder, job, selection, result, ending, arguments);
            if (document)
                *document = members;
            else
                fmt::print("{}", json_document("run", members));
        } else if (!arguments.quiet || code != ExitCode::done)
            fmt::print(arguments.quiet ? stderr : stdout, "{}\n",
                       closing_message(folder, job.plan, selection, result, ending, arguments));
    });
    return code;
}

void print_beginning(const Beginning& beginning, const RunArguments& arguments,
                     Progress& progress) {
    if (!beginning.warning.empty() && !arguments.quiet)
        progress.report("warning: " + beginning.warning);
    for (const SetAside& damaged : beginning.damaged)
        progress.report(
            fmt::format("case {} is damaged ({}): its file was moved to {}, and the case is "
                        "computed again",
                        damaged.id, damaged.reason, damaged.place.string()));
}

void note_beginning(const storage::RunStart& start, const Beginning& beginning,
                    const storage::Journal& journal) {
    journal.run_started(start);
    for (const SetAside& damaged : beginning.damaged)
        journal.damaged(damaged.id, damaged.reason);
}

/// Throws UsageError if the cases to be computed need more memory or disk space than there is,
/// before anything is written. Not collective.
void require_resources(const config::Job& job, const OutputFolder& folder,
                       const RunArguments& arguments, int ranks, double memory_B) {
    storage::CaseIndex index(folder.root);
    const Selection selection = select_cases(job.plan, {}, index, arguments);
    const std::vector<const PlannedCase*> cases = cases_of(job.plan, selection.work);
    const int together =
        arguments.ranks_per_case > 0 ? std::min(arguments.ranks_per_case, ranks) : ranks;
    const std::string error =
        excess(least_demand(cases, together), memory_B, folder.root, run_by_force);
    if (!error.empty()) throw UsageError("error: " + error, ExitCode::environment);
}

/// Throws UsageError for a case that cannot end within the time limit if its engine saves no
/// checkpoints, since every run would start it from scratch. Not collective.
void require_time(const Arrangement& work, const Deadline& deadline) {
    std::optional<std::size_t> longest;
    for (std::size_t i = 0; i < work.cases.size(); ++i)
        if (!engines::capabilities_of(work.cases[i]->physics).steps_in_time &&
            (!longest || work.work[i] > work.work[*longest]))
            longest = i;
    if (!longest || !deadline.exists()) return;
    const PlannedCase& planned = *work.cases[*longest];
    const std::string engine = engine_name(planned.physics.solver);
    const double needed_s = cost::recorded_rate_s(engine).value_or(0.0) * work.work[*longest];
    if (needed_s <= deadline.left_s()) return;
    throw UsageError(
        fmt::format("error: case {} takes about {} on {}, but the time limit leaves {}, "
                    "and the engine {} saves no checkpoints: increase the time limit or "
                    "the ranks per case, or add --force to try it",
                    planned.id, duration_text(needed_s),
                    counted(work.layout.ranks_per_case, "rank"), duration_text(deadline.left_s()),
                    engine),
        ExitCode::bad_job);
}

std::string layout_text(const std::string& name, std::size_t cases, const TeamLayout& layout,
                        int ranks, const OutputFolder& folder) {
    return fmt::format("{}: {} to compute on {} of {}{}, into {}", name, counted(cases, "case"),
                       counted(layout.teams, "team"), counted(layout.ranks_per_case, "rank"),
                       cases > 0 ? idle_ranks_text(layout, ranks, cases) : "",
                       folder.root.string());
}

storage::RunStart start_of(const RunArguments& arguments, const std::string& run, int ranks) {
    return {.run = run,
            .ranks = ranks,
            .overrides = arguments.overrides,
            .git_id = pipeline::program_git_id(),
            .kernels = std::string(simd::name_of(simd::instruction_set())),
            .resumed_by = arguments.resumed_by};
}

/// Prints what is doubtful about the job and the arguments, on rank 0.
void print_warnings(const config::Job& job, const RunArguments& arguments, int ranks,
                    int ranks_here, Progress& progress) {
    if (!job.diagnostics.empty()) fmt::print(stderr, "{}", coloured(warnings_of(job), stderr));
    const std::string excess = excessive_team(arguments.ranks_per_case, ranks);
    if (!excess.empty()) progress.report("warning: " + excess);
    const long cores = ::sysconf(_SC_NPROCESSORS_ONLN);
    if (ranks_here > cores)
        progress.report(fmt::format("warning: {} on the {} of {}: ranks wait for each other, so "
                                    "start at most {}",
                                    counted(ranks_here, "rank"), counted(cores, "core"),
                                    storage::host_name(), cores));
}

/// The cases to compute with their number of teams, and those that resume from checkpoints.
std::string work_text(const config::Job& job, const Selection& selection, const TeamLayout& layout,
                      int ranks, const OutputFolder& folder) {
    const std::string text =
        layout_text(job.plan.name, selection.work.size(), layout, ranks, folder);
    const std::string resumed = resumable_cases(folder, job.plan, selection.work);
    return resumed.empty() ? text : text + "\nresumed from checkpoints: " + resumed;
}

} // namespace

ExitCode run_job(const config::Job& job, const RunArguments& arguments, const Comm& world,
                 Json* document) {
    watch_for_stop_signals(world);
    const std::string run = world.broadcast(storage::process_name());
    const auto began = std::filesystem::file_time_type::clock::now();
    const Deadline deadline(arguments.walltime, world);
    const OutputFolder folder{arguments.out.empty() ? std::filesystem::path("out") / job.plan.name
                                                    : arguments.out};
    Progress progress(arguments.quiet || !world.is_root() ? Progress::Style::quiet
                                                          : Progress::Style::automatic,
                      {.lines = world.is_root() ? arguments.log_json : "",
                       .state = world.is_root() ? folder.progress(run) : "",
                       .folder = folder.root.string()});
    const auto report = [&](const std::string& text) {
        if (world.is_root() && !arguments.quiet) progress.report(text);
    };
    const double memory_B = pipeline::memory_per_rank_B(world);
    if (!arguments.force)
        on_root(world, [&] { require_resources(job, folder, arguments, world.size(), memory_B); });
    const int ranks_here = world.split_by_machine().size();
    if (world.is_root() && !arguments.quiet)
        print_warnings(job, arguments, world.size(), ranks_here, progress);
    Beginning beginning;
    std::optional<storage::ActiveRun> active;
    storage::RunStart start = start_of(arguments, run, world.size());
    on_root(world, [&] { beginning = begin_run(job, folder, arguments, active, start); });
    print_beginning(beginning, arguments, progress);
    if (const std::string text = fall_back_to_cache(folder.cache()); !text.empty()) report(text);
    Selection& selection = beginning.selection;
    share(selection, world);
    const storage::Journal journal(folder.journal(run));
    cost::CaseCosts costs({}, 0.0); // time steps are chosen when the cases run
    const Arrangement work =
        arrange(job.plan, selection.work, arguments.ranks_per_case, memory_B, costs, world);
    if (!arguments.force) on_root(world, [&] { require_time(work, deadline); });
    const TeamLayout& layout = work.layout;
    on_root(world, [&] { report(work_text(job, selection, layout, world.size(), folder)); });
    start.teams = layout.teams;
    start.cases_left = work.cases.size();
    on_root(world, [&] { note_beginning(start, beginning, journal); });

    const Comm team = world.split(layout.team_of(world.rank()));
    const pipeline::JobFacts facts{job.plan.title, job.text,
                                   fmt::format("{}", fmt::join(arguments.overrides, "\n")),
                                   memory_B};
    const WorkList list{work, facts, folder, run, began, arguments, costs, deadline};
    progress.start();
    Worker worker(list, world, team, progress);
    worker.work();
    const WorkResult result = worker.wait_for_others();
    progress.finish();

    on_root(world, [&] { require_files(folder, job.plan, beginning.selection.there, result); });
    return concluded(folder, job, selection, result, arguments, world, run, document);
}

} // namespace shearwake::schedule
