#include "sweep/commands.hpp"

#include "engines/engine.hpp"
#include "io/case_file_reader.hpp"
#include "io/journal.hpp"
#include "io/run_lock.hpp"
#include "parallel/agree.hpp"
#include "parallel/shared_counters.hpp"
#include "sweep/job_source.hpp"
#include "sweep/memory.hpp"
#include "sweep/next_command.hpp"
#include "sweep/output_folder.hpp"
#include "sweep/progress.hpp"
#include "sweep/provenance.hpp"
#include "sweep/run_case.hpp"
#include "sweep/select_cases.hpp"
#include "sweep/stop_signal.hpp"
#include "sweep/teams.hpp"

#include <chrono>
#include <fmt/format.h>
#include <optional>
#include <set>
#include <thread>

namespace shearwake {
namespace {

/// Counters that all teams share.
enum Shared { next_case, done, failed, begun, stopping, signalled, teams_ended, shared_count };

/// One team at work: takes cases from the shared counter until there are none or a stop is asked.
class Worker {
public:
    Worker(const std::vector<const PlannedCase*>& work, const JobFacts& facts,
           const OutputFolder& folder, const Comm& world, const Comm& team,
           const RunArguments& arguments, Progress& progress)
        : work_(work), facts_(facts), folder_(folder), journal_(folder.journal()), world_(world),
          team_(team), counters_(world, shared_count), arguments_(arguments), progress_(progress) {}

    void work() {
        while (true) {
            long index = -1;
            if (team_.is_root()) {
                if (stop_asked()) counters_.fetch_add(stopping, 1);
                const bool go_on = counters_.read(stopping) == 0;
                index = go_on ? counters_.fetch_add(next_case, 1) : -1;
            }
            index = team_.broadcast(index);
            if (index < 0 || index >= static_cast<long>(work_.size())) break;
            one_case(*work_[static_cast<std::size_t>(index)]);
        }
        if (team_.is_root()) counters_.fetch_add(teams_ended, 1);
    }

    /// Rank 0 goes on telling while the other teams finish. Collective over the world.
    void wait_for_others(long teams) {
        while (world_.is_root() && counters_.read(teams_ended) < teams) {
            tick();
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        world_.barrier();
        last_tick_ = {}; // the last word is said in any case
        tick();
    }

    long failures() { return world_.broadcast(world_.is_root() ? counters_.read(failed) : 0); }
    long finished() { return world_.broadcast(world_.is_root() ? counters_.read(done) : 0); }
    bool stopped() {
        return world_.broadcast(world_.is_root() ? counters_.read(stopping) : 0) != 0;
    }

private:
    void one_case(const PlannedCase& planned) {
        if (team_.is_root()) counters_.fetch_add(begun, 1);
        try {
            on_root(team_, [&] { journal_.started(planned.id, team_.size()); });
            if (!engine_) engine_ = make_engine(planned.physics.solver);
            CaseCheckpoints checkpoints(folder_.checkpoints(planned.id),
                                        {planned.id, program_git_id()}, arguments_.checkpoints,
                                        team_, journal_,
                                        {[this] { return stop_asked(); },
                                         [this](const auto& text) { progress_.say(text); }});
            const auto outcome =
                run_case(planned, facts_, *engine_, team_, folder_.case_file(planned.id),
                         checkpoints, [this] { tick(); });
            if (outcome) on_root(team_, [&] { journal_.finished(planned.id, outcome->seconds); });
            if (outcome) tell(planned, outcome->solver);
            if (team_.is_root()) counters_.fetch_add(outcome ? done : begun, outcome ? 1 : -1);
        } catch (const CaseFailure& failure) {
            record(planned, failure.what());
        } catch (const UsageError& failure) { // the file system refuses: this case's trouble alone
            record(planned, failure.what());
        }
        tick();
    }

    /// One line of what iterated or chose what no case before it did; else nothing.
    void tell(const PlannedCase& planned, const SolverReport& solver) {
        std::vector<std::string> news;
        if (solver.iterations > 0)
            news.push_back(fmt::format("{} steps, {} iterations, {} at most in a step",
                                       solver.steps, solver.iterations, solver.most_iterations));
        for (const std::string& note : solver.notes)
            if (told_.insert(note).second) news.push_back(note);
        if (team_.is_root() && !news.empty() && !arguments_.quiet)
            progress_.say(fmt::format("case {}: {}", planned.id, fmt::join(news, "; ")));
    }

    /// All ranks of the team are here. What a failed case leaves in the engine is not trusted.
    void record(const PlannedCase& planned, const std::string& reason) {
        engine_.reset();
        if (!team_.is_root()) return;
        progress_.say(fmt::format("case {} failed: {}", planned.id, reason));
        try {
            journal_.failed(planned.id, reason);
        } catch (const UsageError& error) {
            progress_.say(fmt::format("and the journal cannot be written: {}", error.what()));
        }
        counters_.fetch_add(failed, 1);
        if (arguments_.fail_fast) counters_.fetch_add(stopping, 1);
    }

    /// Whether a signal has come to any team's root. Called by roots between the steps of a case,
    /// so it asks rank 0's memory only now and then.
    bool stop_asked() {
        if (!signal_told_ && stop_requested()) {
            signal_told_ = true;
            counters_.fetch_add(signalled, 1);
        }
        const auto now = std::chrono::steady_clock::now();
        if (!signal_seen_ && now - last_look_ > std::chrono::milliseconds(50)) {
            last_look_ = now;
            signal_seen_ = counters_.read(signalled) > 0;
        }
        return signal_told_ || signal_seen_;
    }

    void tick() {
        if (!world_.is_root()) return;
        const auto now = std::chrono::steady_clock::now();
        if (now - last_tick_ < std::chrono::milliseconds(50)) return;
        last_tick_ = now;
        SweepCounts counts{.total = static_cast<long>(work_.size()),
                           .done = counters_.read(done),
                           .failed = counters_.read(failed)};
        counts.running = counters_.read(begun) - counts.done - counts.failed;
        progress_.update(counts);
    }

    const std::vector<const PlannedCase*>& work_;
    const JobFacts& facts_;
    const OutputFolder& folder_;
    Journal journal_;
    const Comm& world_;
    const Comm& team_;
    SharedCounters counters_;
    std::unique_ptr<Engine> engine_;
    const RunArguments& arguments_;
    Progress& progress_;
    std::set<std::string> told_; // notes of engines
    std::chrono::steady_clock::time_point last_tick_{}, last_look_{};
    bool signal_told_ = false, signal_seen_ = false;
};

std::vector<std::string> ids_of(const Plan& plan, const std::vector<std::size_t>& indices) {
    std::vector<std::string> ids;
    for (const std::size_t index : indices)
        ids.push_back(plan.cases[index].id);
    return ids;
}

std::string warnings_of(const Job& job) {
    std::string all;
    for (const Finding& finding : job.findings)
        all += text(finding) + "\n";
    return all;
}

std::string epilogue(const OutputFolder& folder, const Selection& selection, long finished,
                     long failures, bool stopped, const RunArguments& arguments) {
    std::string text =
        fmt::format("{} cases: {} computed now, {} there before, {} failed", selection.total,
                    finished, selection.whole, failures + selection.failed_before);
    if (selection.not_selected > 0)
        text += fmt::format(", {} not selected", selection.not_selected);
    if (stopped)
        return text +
               fmt::format("\nstopped early, everything computed is saved\nnext: {}",
                           run_command_line(arguments.job, arguments.overrides, arguments.out));
    if (selection.failed_before > 0)
        text += "\ncases that failed before are not tried again without --retry-failed";
    if (failures + selection.failed_before > 0)
        text += "\nreasons: shearwake status " + shell_word(folder.root.string());
    return text + fmt::format("\nresults: {}\nnext: {}", folder.cases().string(),
                              reduce_command_line(folder));
}

} // namespace

ExitCode run_command(const RunArguments& arguments, const Comm& world) {
    const Job job = load_job(arguments.job, arguments.overrides, world);
    const OutputFolder folder{arguments.out.empty() ? std::filesystem::path("out") / job.plan.name
                                                    : arguments.out};
    Progress progress(arguments.quiet || !world.is_root() ? Progress::Style::quiet
                                                          : Progress::Style::automatic);
    if (world.is_root() && !arguments.quiet && !job.findings.empty())
        fmt::print(stderr, "{}", warnings_of(job));

    Selection selection;
    std::optional<RunLock> lock; // to the end of the run
    on_root(world, [&] {
        prepare_output(folder, job);
        const bool part_only = !arguments.shard.empty() || !arguments.only.empty();
        lock.emplace(folder.journal(),
                     part_only ? RunLock::Sharing::with_others : RunLock::Sharing::alone);
        selection = select_cases(job.plan, folder, arguments);
        clear_half_written(folder, job.plan, ids_of(job.plan, selection.work));
    });
    selection = share(selection, world);
    std::vector<const PlannedCase*> cases, work;
    for (const std::size_t index : selection.work)
        cases.push_back(&job.plan.cases[index]);
    for (const std::size_t index : order_of_work(cases))
        work.push_back(cases[index]);

    const double memory_B = memory_per_rank_B(world);
    const TeamLayout layout = choose_teams(work, world.size(), arguments.ranks_per_case, memory_B);
    if (world.is_root() && !arguments.quiet)
        progress.say(fmt::format("{}: {} cases to compute on {} team{} of {} rank{}, into {}",
                                 job.plan.name, work.size(), layout.teams,
                                 layout.teams == 1 ? "" : "s", layout.ranks_per_case,
                                 layout.ranks_per_case == 1 ? "" : "s", folder.root.string()));
    const Journal journal(folder.journal());
    on_root(world, [&] {
        journal.run_started(world.size(), layout.teams, work.size(), arguments.overrides);
    });

    watch_for_stop_signals();
    const Comm team = world.split(layout.team_of(world.rank()));
    const JobFacts facts{job.plan.title, job.text,
                         fmt::format("{}", fmt::join(arguments.overrides, "\n")), memory_B};
    Worker worker(work, facts, folder, world, team, arguments, progress);
    worker.work();
    worker.wait_for_others(layout.teams);
    progress.finish();

    const long failures = worker.failures(), finished = worker.finished();
    const bool all_ended = failures + finished == static_cast<long>(work.size());
    const bool stopped = worker.stopped() && !all_ended && !(arguments.fail_fast && failures > 0);
    on_root(world, [&] {
        journal.run_ended(stopped ? "stopped" : failures > 0 ? "with failures" : "done");
    });
    if (world.is_root())
        fmt::print("{}\n", epilogue(folder, selection, finished, failures, stopped, arguments));
    if (stopped) return ExitCode::stopped_early;
    return failures + selection.failed_before > 0 ? ExitCode::some_cases_failed : ExitCode::done;
}

} // namespace shearwake
