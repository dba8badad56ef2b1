// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run.hpp"

#include "cost/calibration.hpp"
#include "parallel/agree.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/deadline.hpp"
#include "schedule/job_source.hpp"
#include "schedule/machine_limits.hpp"
#include "schedule/next_command.hpp"
#include "schedule/output_folder.hpp"
#include "schedule/progress.hpp"
#include "schedule/select_cases.hpp"
#include "schedule/stop_signal.hpp"
#include "schedule/teams.hpp"
#include "schedule/worker.hpp"
#include "simd/instruction_set.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/run_lock.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <memory>
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

/// The remaining cases in the order in which they are started.
struct OrderedWork {
    std::vector<const PlannedCase*> cases;
    std::vector<std::size_t> numbers; // of the cases in the plan
};

/// Whether the folder contains complete cases of another version of the program. Throws UsageError
/// if this is not allowed.
bool is_mixed(const Plan& plan, storage::CaseIndex& index, const RunArguments& arguments) {
    for (const PlannedCase& c : plan.cases) {
        const storage::CaseDigest* digest = index.find(c.id);
        if (!digest || !digest->whole() || digest->git_id == pipeline::program_git_id()) continue;
        if (arguments.allow_mixed) return true;
        throw UsageError(fmt::format(
            "case {} was computed by another version of this program, {}; this one is {}. Choose "
            "another folder with --out, or use --allow-mixed to mix the results; case files and "
            "the journal record the versions",
            digest->id, digest->git_id, pipeline::program_git_id()));
    }
    return false;
}

/// Locks the folder and reads its state, on rank 0. `locks` must exist until the end of the run.
Beginning begin_run(const config::Job& job, const OutputFolder& folder,
                    const RunArguments& arguments,
                    std::vector<std::unique_ptr<storage::RunLock>>& locks,
                    storage::RunStart& start) {
    const std::string warning = prepare_output(folder, job);
    const std::string part = part_name(arguments);
    const auto sharing =
        part.empty() ? storage::RunLock::Sharing::alone : storage::RunLock::Sharing::with_others;
    // Each run acquires its own lock before it looks for those of others.
    if (!part.empty())
        locks.push_back(std::make_unique<storage::RunLock>(folder.part_lock(part),
                                                           storage::RunLock::Sharing::alone));
    locks.push_back(std::make_unique<storage::RunLock>(folder.run_lock(), sharing));
    if (part.empty()) storage::refuse_beside_parts(folder.run_lock().parent_path());
    storage::CaseIndex index(folder.root);
    Beginning beginning{.selection = {},
                        .journal = storage::read_journals(folder.root),
                        .damaged = {},
                        .warning = warning};
    beginning.selection = select_cases(job.plan, beginning.journal, index, arguments);
    start.allow_mixed = is_mixed(job.plan, index, arguments);
    beginning.damaged = set_damaged_aside(folder, job.plan, beginning.selection.work, index);
    clear_half_written(folder, job.plan, beginning.selection.work, index, sharing);
    index.save();
    return beginning;
}

/// Throws UsageError if the folder or case files have been removed during the run, so that the
/// sweep is not reported as complete. Not collective.
void must_be_there(const OutputFolder& folder, const Plan& plan,
                   const std::vector<std::size_t>& there, const WorkResult& result) {
    if (result.folder_gone || folder.has_lost_plan())
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
            std::error_code trouble;
            const bool is_there = std::filesystem::exists(folder.case_file(id), trouble);
            if (!is_there && !trouble) lost.push_back(id);
        }
    if (lost.empty()) return;
    throw UsageError(fmt::format("{} case files were removed from {} during the run, the first is "
                                 "{}.h5; rerun the command to compute them again",
                                 lost.size(), folder.cases().string(), lost.front()),
                     ExitCode::environment);
}

std::string epilogue(const OutputFolder& folder, const Selection& selection,
                     const WorkResult& result, bool stopped, const RunArguments& arguments) {
    std::string text =
        fmt::format("{} cases: {} computed now, {} already complete, {} failed", selection.total,
                    result.done, selection.whole, result.failed + selection.failed_before);
    if (selection.not_selected > 0)
        text += fmt::format(", {} not selected", selection.not_selected);
    if (result.elsewhere > 0) text += fmt::format(", {} by other runs", result.elsewhere);
    if (stopped) {
        if (result.put_off > 0)
            text += fmt::format("\n{} cases were not started, since they cannot finish within the "
                                "remaining time",
                                result.put_off);
        if (std::error_code none; std::filesystem::exists(folder.stop_file(), none))
            text += fmt::format("\n{} stops all runs: remove it to continue",
                                shell_word(folder.stop_file().string()));
        text += fmt::format("\nstopped early, all computed results are saved\nnext: {}",
                            run_command_line(arguments));
        if (stop_requested() && std::getenv("OMPI_COMM_WORLD_SIZE"))
            text +=
                "\nexit code 75; if mpirun itself received the signal, it may exit with another "
                "code (1, 130 or 143)";
        return text;
    }
    const long left = static_cast<long>(selection.work.size()) - result.done - result.failed -
                      result.put_off - result.elsewhere;
    if (left > 0)
        text += fmt::format("\n{} cases were not started: {} computes them", left,
                            run_command_line(arguments));
    if (selection.failed_before > 0)
        text += "\ncases that failed before are only retried with --retry-failed";
    if (result.failed + selection.failed_before > 0)
        text += "\nreasons: shearwake status " + shell_word(folder.root.string());
    if (result.failed_files > 0)
        text += fmt::format("\n{} of them failed because of files or disks: rerun the command to "
                            "retry them",
                            result.failed_files);
    text += "\nresults: " + folder.cases().string();
    if (arguments.resumed_by.empty()) text += "\nnext: " + reduce_command_line(folder);
    return text;
}

/// Whether the remaining cases are left for a later run. A requested stop has priority over
/// failures; otherwise failures of files and --fail-fast determine the exit code.
bool was_stopped(const WorkResult& result) {
    if (result.asked_to_stop) return true;
    if (result.given_up) return false;
    return result.put_off > 0 || (result.elsewhere > 0 && result.failed_files == 0);
}

ExitCode code_of(const WorkResult& result, const Selection& selection, bool stopped) {
    if (stopped) return ExitCode::stopped_early;
    if (result.failed_files > 0) return ExitCode::environment;
    return result.failed + selection.failed_before > 0 ? ExitCode::some_cases_failed
                                                       : ExitCode::done;
}

void say_beginning(const Beginning& beginning, const RunArguments& arguments, Progress& progress) {
    if (!beginning.warning.empty() && !arguments.quiet)
        progress.say("warning: " + beginning.warning);
    for (const SetAside& damaged : beginning.damaged)
        progress.say(
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

OrderedWork ordered(const std::vector<const PlannedCase*>& cases, const Selection& selection,
                    cost::CaseCosts& costs) {
    OrderedWork work;
    for (const std::size_t index : order_of_work(cases, costs)) {
        work.cases.push_back(cases[index]);
        work.numbers.push_back(selection.work[index]);
    }
    return work;
}

/// Throws UsageError if the cases to be computed need more memory or disk space than there is,
/// before anything is written. Not collective.
void must_fit(const config::Job& job, const OutputFolder& folder, const RunArguments& arguments,
              int ranks, double memory_B) {
    storage::CaseIndex index(folder.root);
    const Selection selection = select_cases(job.plan, {}, index, arguments);
    std::vector<const PlannedCase*> cases;
    for (const std::size_t number : selection.work)
        cases.push_back(&job.plan.cases[number]);
    const int together =
        arguments.ranks_per_case > 0 ? std::min(arguments.ranks_per_case, ranks) : ranks;
    const std::string error =
        excess(least_demand(cases, together), memory_B, folder.root, run_by_force);
    if (!error.empty()) throw UsageError("error: " + error, ExitCode::environment);
}

std::string layout_text(const std::string& name, std::size_t cases, const TeamLayout& layout,
                        const OutputFolder& folder) {
    return fmt::format("{}: {} cases to compute on {} team{} of {} rank{}, into {}", name, cases,
                       layout.teams, layout.teams == 1 ? "" : "s", layout.ranks_per_case,
                       layout.ranks_per_case == 1 ? "" : "s", folder.root.string());
}

} // namespace

ExitCode run_sweep(const RunArguments& arguments, const Comm& world) {
    return run_job(load_job(arguments.job, arguments.overrides, world), arguments, world);
}

ExitCode run_job(const config::Job& job, const RunArguments& arguments, const Comm& world) {
    const Deadline deadline(arguments.walltime, world);
    const OutputFolder folder{arguments.out.empty() ? std::filesystem::path("out") / job.plan.name
                                                    : arguments.out};
    Progress progress(arguments.quiet || !world.is_root() ? Progress::Style::quiet
                                                          : Progress::Style::automatic,
                      world.is_root() ? arguments.log_json : "");
    if (world.is_root() && !arguments.quiet && !job.diagnostics.empty())
        fmt::print(stderr, "{}", warnings_of(job));

    const double memory_B = pipeline::memory_per_rank_B(world);
    if (!arguments.force)
        on_root(world, [&] { must_fit(job, folder, arguments, world.size(), memory_B); });
    watch_for_stop_signals();
    Beginning beginning;
    std::vector<std::unique_ptr<storage::RunLock>> locks; // held until the end of the run
    storage::RunStart start{.ranks = world.size(),
                            .overrides = arguments.overrides,
                            .git_id = pipeline::program_git_id(),
                            .kernels = std::string(simd::name_of(simd::instruction_set()))};
    on_root(world, [&] { beginning = begin_run(job, folder, arguments, locks, start); });
    say_beginning(beginning, arguments, progress);
    const Selection selection = share(beginning.selection, world);
    std::vector<const PlannedCase*> cases;
    for (const std::size_t index : selection.work)
        cases.push_back(&job.plan.cases[index]);
    cost::CaseCosts costs(cases, {});
    calibrate_for(costs, world.size(), world, [&](const std::string& text) {
        if (!arguments.quiet) progress.say(text);
    });
    const OrderedWork work = ordered(cases, selection, costs);

    const TeamLayout layout =
        choose_teams(work.cases, world.size(), arguments.ranks_per_case, memory_B, costs);
    if (world.is_root() && !arguments.quiet)
        progress.say(layout_text(job.plan.name, work.cases.size(), layout, folder));
    const std::string part = part_name(arguments);
    const storage::Journal journal(folder.journal(part));
    start.teams = layout.teams;
    start.cases_left = work.cases.size();
    on_root(world, [&] { note_beginning(start, beginning, journal); });

    const Comm team = world.split(layout.team_of(world.rank()));
    const pipeline::JobFacts facts{job.plan.title, job.text,
                                   fmt::format("{}", fmt::join(arguments.overrides, "\n")),
                                   memory_B};
    const WorkList list{work.cases, work.numbers, facts,    folder,       part,
                        arguments,  costs,        deadline, layout.teams, layout.ranks_per_case};
    progress.start();
    Worker worker(list, beginning.journal, world, team, progress);
    worker.work();
    const WorkResult result = worker.wait_for_others();
    progress.finish();

    on_root(world, [&] { must_be_there(folder, job.plan, beginning.selection.there, result); });
    const bool all_ended = result.failed + result.done == static_cast<long>(work.cases.size());
    const bool stopped = !all_ended && was_stopped(result);
    const char* ending = stopped ? "stopped" : result.failed > 0 ? "with failures" : "done";
    on_root(world, [&] { journal.run_ended(ending, result.times); });
    const ExitCode code = code_of(result, selection, stopped);
    if (world.is_root() && !arguments.quiet)
        fmt::print("{}\n", epilogue(folder, selection, result, stopped, arguments));
    else if (world.is_root() && code != ExitCode::done)
        fmt::print(stderr, "{}\n", epilogue(folder, selection, result, stopped, arguments));
    return code;
}

} // namespace shearwake::schedule
