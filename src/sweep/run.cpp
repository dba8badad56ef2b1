#include "sweep/commands.hpp"

#include "io/case_index.hpp"
#include "io/journal.hpp"
#include "io/run_lock.hpp"
#include "parallel/agree.hpp"
#include "sweep/deadline.hpp"
#include "sweep/job_source.hpp"
#include "sweep/machine.hpp"
#include "sweep/memory.hpp"
#include "sweep/next_command.hpp"
#include "sweep/output_folder.hpp"
#include "sweep/progress.hpp"
#include "sweep/provenance.hpp"
#include "sweep/select_cases.hpp"
#include "sweep/stop_signal.hpp"
#include "sweep/teams.hpp"
#include "sweep/worker.hpp"

#include <fmt/format.h>
#include <memory>
#include <vector>

namespace shearwake {
namespace {

std::string warnings_of(const Job& job) {
    std::string all;
    for (const Finding& finding : job.findings)
        all += text(finding) + "\n";
    return all;
}

/// What this run is told to do, and what is there of it.
struct Beginning {
    Selection selection;
    JournalContents journal;
};

/// Whether the folder holds whole cases of another version of this program.
bool is_mixed(const Plan& plan, CaseIndex& index, const RunArguments& arguments) {
    for (const PlannedCase& c : plan.cases) {
        const CaseDigest* digest = index.find(c.id);
        if (!digest || !digest->whole() || digest->git_id == program_git_id()) continue;
        if (arguments.allow_mixed) return true;
        throw UsageError(fmt::format(
            "{} holds results of another version of this program, {}; this one is {}. Choose "
            "another folder with --out, or mix them with --allow-mixed, which every case file and "
            "the journal record",
            digest->id, digest->git_id, program_git_id()));
    }
    return false;
}

/// Locks the folder and looks at what is there, on rank 0. `locks` last to the end of the run.
Beginning begin_run(const Job& job, const OutputFolder& folder, const RunArguments& arguments,
                    std::vector<std::unique_ptr<RunLock>>& locks, RunStart& start) {
    prepare_output(folder, job);
    const std::string part = part_name(arguments);
    const auto sharing = part.empty() ? RunLock::Sharing::alone : RunLock::Sharing::with_others;
    // Each writes its own count before it looks for the other's.
    if (!part.empty())
        locks.push_back(std::make_unique<RunLock>(folder.part_lock(part), RunLock::Sharing::alone));
    locks.push_back(std::make_unique<RunLock>(folder.run_lock(), sharing));
    if (part.empty()) refuse_beside_parts(folder.run_lock().parent_path());
    CaseIndex index(folder.root);
    Beginning beginning{.selection = {}, .journal = read_journals(folder.root)};
    beginning.selection = select_cases(job.plan, beginning.journal, index, arguments);
    start.allow_mixed = is_mixed(job.plan, index, arguments);
    clear_half_written(folder, job.plan, beginning.selection.work, index, sharing);
    index.save();
    return beginning;
}

/// Nobody may take a sweep for done that is not there any more. Not collective.
void must_be_there(const OutputFolder& folder, const Plan& plan,
                   const std::vector<std::size_t>& there, const WorkResult& result) {
    if (result.folder_gone || folder.has_lost_plan())
        throw UsageError(fmt::format("the output folder {} has gone in mid-run (it has no "
                                     "plan.json any more): stopped; the same command begins anew",
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
    throw UsageError(fmt::format("{} case files have been removed in mid-run from {}, {}.h5 the "
                                 "first; the same command computes them again",
                                 lost.size(), folder.cases().string(), lost.front()),
                     ExitCode::environment);
}

std::string epilogue(const OutputFolder& folder, const Selection& selection,
                     const WorkResult& result, bool stopped, const RunArguments& arguments) {
    std::string text =
        fmt::format("{} cases: {} computed now, {} there before, {} failed", selection.total,
                    result.done, selection.whole, result.failed + selection.failed_before);
    if (selection.not_selected > 0)
        text += fmt::format(", {} not selected", selection.not_selected);
    if (result.elsewhere > 0) text += fmt::format(", {} by other runs", result.elsewhere);
    if (stopped) {
        if (result.put_off > 0)
            text += fmt::format("\n{} cases would not have ended within the time that is left",
                                result.put_off);
        if (std::error_code none; std::filesystem::exists(folder.stop_file(), none))
            text += fmt::format("\n{} asks for a stop: remove it to go on",
                                shell_word(folder.stop_file().string()));
        return text + fmt::format("\nstopped early, everything computed is saved\nnext: {}",
                                  run_command_line(arguments));
    }
    const long left = static_cast<long>(selection.work.size()) - result.done - result.failed -
                      result.put_off - result.elsewhere;
    if (left > 0)
        text += fmt::format("\n{} cases were never begun: {} goes on with them", left,
                            run_command_line(arguments));
    if (selection.failed_before > 0)
        text += "\ncases that failed before are not tried again without --retry-failed";
    if (result.failed + selection.failed_before > 0)
        text += "\nreasons: shearwake status " + shell_word(folder.root.string());
    if (result.failed_files > 0)
        text += fmt::format("\n{} of them by files and disks: the same command tries them again",
                            result.failed_files);
    return text + fmt::format("\nresults: {}\nnext: {}", folder.cases().string(),
                              reduce_command_line(folder));
}

/// Whether what is left was left for a later run. Whoever asks for a stop gets it, whatever failed
/// before; else files and the first failure have their own word.
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

} // namespace

ExitCode run_command(const RunArguments& arguments, const Comm& world) {
    const Deadline deadline(arguments.walltime, world);
    const Job job = load_job(arguments.job, arguments.overrides, world);
    const OutputFolder folder{arguments.out.empty() ? std::filesystem::path("out") / job.plan.name
                                                    : arguments.out};
    Progress progress(arguments.quiet || !world.is_root() ? Progress::Style::quiet
                                                          : Progress::Style::automatic,
                      world.is_root() ? arguments.log_json : "");
    if (world.is_root() && !arguments.quiet && !job.findings.empty())
        fmt::print(stderr, "{}", warnings_of(job));

    watch_for_stop_signals();
    Beginning beginning;
    std::vector<std::unique_ptr<RunLock>> locks; // to the end of the run
    RunStart start{
        .ranks = world.size(), .overrides = arguments.overrides, .git_id = program_git_id()};
    on_root(world, [&] { beginning = begin_run(job, folder, arguments, locks, start); });
    const Selection selection = share(beginning.selection, world);
    std::vector<const PlannedCase*> cases, work;
    std::vector<std::size_t> numbers;
    for (const std::size_t index : selection.work)
        cases.push_back(&job.plan.cases[index]);
    CaseCosts costs(cases, machine_of_root(world));
    for (const std::size_t index : order_of_work(cases, costs)) {
        work.push_back(cases[index]);
        numbers.push_back(selection.work[index]);
    }

    const double memory_B = memory_per_rank_B(world);
    const TeamLayout layout =
        choose_teams(work, world.size(), arguments.ranks_per_case, memory_B, costs);
    if (world.is_root() && !arguments.quiet)
        progress.say(fmt::format("{}: {} cases to compute on {} team{} of {} rank{}, into {}",
                                 job.plan.name, work.size(), layout.teams,
                                 layout.teams == 1 ? "" : "s", layout.ranks_per_case,
                                 layout.ranks_per_case == 1 ? "" : "s", folder.root.string()));
    const std::string part = part_name(arguments);
    const Journal journal(folder.journal(part));
    start.teams = layout.teams;
    start.cases_left = work.size();
    on_root(world, [&] { journal.run_started(start); });

    const Comm team = world.split(layout.team_of(world.rank()));
    const JobFacts facts{job.plan.title, job.text,
                         fmt::format("{}", fmt::join(arguments.overrides, "\n")), memory_B};
    const WorkList list{work,      numbers, facts,    folder,      part,
                        arguments, costs,   deadline, layout.teams};
    Worker worker(list, beginning.journal, world, team, progress);
    worker.work();
    const WorkResult result = worker.wait_for_others();
    progress.finish();

    on_root(world, [&] { must_be_there(folder, job.plan, beginning.selection.there, result); });
    const bool all_ended = result.failed + result.done == static_cast<long>(work.size());
    const bool stopped = !all_ended && was_stopped(result);
    on_root(world, [&] {
        journal.run_ended(stopped             ? "stopped"
                          : result.failed > 0 ? "with failures"
                                              : "done",
                          result.times);
    });
    if (world.is_root())
        fmt::print("{}\n", epilogue(folder, selection, result, stopped, arguments));
    return code_of(result, selection, stopped);
}

} // namespace shearwake
