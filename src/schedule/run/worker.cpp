// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/worker.hpp"

#include "parallel/agree.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/cost/rates.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <thread>

namespace shearwake::schedule {
namespace {

using namespace std::chrono_literals;

/// Waiting times before a case that failed because of a file is tried again.
constexpr std::array waits_for_files = {1s, 5s};
/// After this number of consecutive file errors, further cases would probably fail as well.
constexpr int most_file_failures_in_a_row = 3;

struct CaseError {
    std::string reason;
    storage::Cause cause = storage::Cause::case_itself;
    Persistence persistence = Persistence::lasting;
};

/// The error that ends `work`, if any. The errors of a case do not end the run.
template <class Work>
std::optional<CaseError> error_of(const Work& work) {
    try {
        try {
            work();
        } catch (const FileFailure& failure) {
            return CaseError{failure.what(), storage::Cause::files, failure.persistence()};
        } catch (const CaseFailure& failure) {
            return CaseError{failure.what()};
        } catch (const UsageError& failure) { // of the file system
            return CaseError{failure.what(), storage::Cause::files, failure.persistence()};
        }
    } catch (const std::bad_alloc&) {
        return CaseError{"out of memory"};
    }
    return {};
}

/// The name of this host if it differs from that of rank 0, otherwise empty. Collective.
std::string further_host(const Comm& world) {
    const std::string mine = storage::host_name();
    return world.broadcast(mine) == mine ? "" : mine;
}

} // namespace

Worker::Worker(const WorkList& list, const Comm& world, const Comm& team, Progress& progress)
    : list_(list), world_(world), team_(team), progress_(progress), host_(further_host(world)),
      journal_(list.folder.journal(list.run, host_)), counters_(world, shared_count) {
    together(world, [&] {
        if (team_.is_root()) claims_.emplace(list_.folder.locks(), list_.run);
    });
    computed_.reserve(list_.work.cases.size());
    const double all = std::accumulate(list_.work.work.begin(), list_.work.work.end(), 0.0);
    if (world.is_root()) counters_.fetch_add(work_left, std::lround(all));
}

void Worker::work() {
    began_ = Clock::now();
    const TeamLayout& layout = list_.work.layout;
    if (layout.team_of(world_.rank()) == layout.teams) return; // an idle rank
    while (true) {
        long index = -1;
        if (team_.is_root()) index = next();
        index = team_.broadcast(index);
        if (index == no_case) break;
        if (index == no_case_yet) {
            wait();
            continue;
        }
        const std::size_t number = list_.work.numbers[static_cast<std::size_t>(index)];
        at_ = static_cast<std::size_t>(index);
        const bool is_done = one_case(*list_.work.cases[at_]);
        if (!team_.is_root()) continue;
        if (is_done && counted_work_) count_work(1.0);
        leave_out(at_);
        claims_->release(list_.work.cases[at_]->id);
        if (is_done) computed_.push_back(static_cast<double>(number));
    }
    if (team_.is_root()) counters_.fetch_add(teams_ended, 1);
}

/// Work before the first share of a resumed case does not show the speed of this run.
void Worker::count_work(double share) {
    const long work = std::lround(share * list_.work.work[at_]);
    const long more = work - counted_work_.value_or(0);
    if (counted_work_) counters_.fetch_add(work_done, more);
    counters_.fetch_add(work_left, -more);
    counted_work_ = work;
}

void Worker::leave_out(std::size_t place) {
    counters_.fetch_add(work_left, counted_work_.value_or(0) - std::lround(list_.work.work[place]));
    counted_work_.reset();
}

/// Computes a case and repeats it after a temporary failure of the file system. A failure of any
/// rank ends the attempt on all ranks of the team. Returns whether the case is complete.
bool Worker::one_case(const PlannedCase& planned) {
    if (team_.is_root()) counters_.fetch_add(begun, 1);
    tick(); // reports the estimate
    case_log_.clear();
    bool is_done = false;
    for (std::size_t attempt = 0;; ++attempt) {
        const std::optional<CaseError> error =
            error_of([&] { fail_together(team_, [&] { is_done = compute(planned); }); });
        // A rank that lacks the memory to describe the error has to decide as the others do.
        if (!team_.any(error.has_value())) {
            file_failures_in_a_row_ = 0;
            break;
        }
        is_done = false;
        list_.costs.free_engines(); // their data may be incomplete
        shared_.clear();
        const bool passing = error && error->persistence == Persistence::passing;
        if (!team_.all(passing) || attempt == waits_for_files.size()) {
            if (team_.is_root() && error) {
                if (claims_->holds(planned.id)) {
                    record(planned, error->reason, error->cause);
                } else { // another run has taken it over, since this one has stood still for long
                    counters_.fetch_add(begun, -1);
                    counters_.fetch_add(work_left, std::lround(list_.work.work[at_])); // it is left
                    deferred_.push_back(at_);
                }
            }
            break;
        }
        if (team_.is_root())
            report(fmt::format("case {} is tried again in {} s: {}", planned.id,
                               waits_for_files[attempt].count(), error->reason));
        std::this_thread::sleep_for(waits_for_files[attempt]);
    }
    before_ = &planned.physics;
    if (team_.is_root()) show_share(0.0);
    return is_done;
}

/// Returns whether the case is complete; otherwise a checkpoint has been saved.
bool Worker::compute(const PlannedCase& planned) {
    on_root(team_, [&] { journal_.started(planned.id, team_.size()); });
    // What an engine shares between its cases is in the way of another engine's.
    if (before_ && before_->solver.index() != planned.physics.solver.index()) {
        list_.costs.free_engines();
        shared_.clear();
    }
    pipeline::CaseCheckpoints checkpoints(
        list_.folder.checkpoints(planned.id), {planned.id, pipeline::program_git_id()},
        list_.arguments.checkpoints, team_, journal_,
        {[this] { return stop_asked(); }, [this](const auto& text) { report(text); },
         [this](double share) {
             count_work(share);
             show_share(share);
         }});
    if (team_.is_root() && !checkpoints.has_state()) count_work(0.0);
    const auto began = Clock::now();
    const double earlier_s = checkpoints.earlier_seconds();
    auto outcome =
        pipeline::run_case(planned, list_.facts, list_.costs.engine_of(planned.physics), team_,
                           list_.folder.case_file(planned.id), checkpoints, [this] { tick(); });
    if (!outcome) {
        if (team_.is_root()) counters_.fetch_add(begun, -1);
        return false;
    }
    on_root(team_, [&] {
        journal_.finished(planned.id, earlier_s + seconds_since(began),
                          engine_name(planned.physics.solver), outcome->checksum);
        storage::add_to_index(list_.folder.index(list_.run, host_),
                              list_.folder.case_file(planned.id), outcome->digest);
        std::error_code ignored;
        std::filesystem::remove(list_.folder.failure(planned.id), ignored);
    });
    report(planned, *outcome);
    if (!team_.is_root()) return true;
    const engines::Resources& needs = outcome->needs;
    if (!outcome->is_resumed) {
        Measured& all = measured_.at(planned.physics.solver.index());
        all.core_s += seconds_since(began) * std::min(team_.size(), needs.useful_ranks);
        all.work += needs.work + (needs.shared == shared_ ? 0.0 : needs.shared_work);
    }
    shared_ = needs.shared;
    counters_.fetch_add(done, 1);
    return true;
}

void Worker::record_rates() const {
    for (std::size_t i = 0; i < measured_.size(); ++i) {
        const double core_s = world_.sum(measured_[i].core_s), work = world_.sum(measured_[i].work);
        if (world_.is_root() && work > 0.0) cost::record_rate_s(engine_names()[i], core_s / work);
    }
}

/// Prints the warnings that the computation of the case has added and, if requested, its iterations
/// and choices; each text once.
void Worker::report(const PlannedCase& planned, const pipeline::CaseOutcome& outcome) try {
    if (!team_.is_root() || list_.arguments.quiet) return;
    for (const Remark& remark : outcome.discovered)
        if (reported_.insert(remark.message).second)
            progress_.report(fmt::format("case {}: {}: {}: {}", planned.id,
                                         remark.severity == Severity::error ? "error" : "warning",
                                         remark.key, remark.message));
    if (!list_.arguments.verbose) return;
    const engines::SolverReport& solver = outcome.solver;
    std::vector<std::string> news;
    if (solver.iterations > 0)
        news.push_back(fmt::format("{} steps, {} iterations, {} at most in a step", solver.steps,
                                   solver.iterations, solver.most_iterations));
    for (const std::string& note : solver.notes)
        if (reported_.insert(note).second) news.push_back(note);
    if (!news.empty())
        progress_.report(fmt::format("case {}: {}", planned.id, fmt::join(news, "; ")));
} catch (const std::bad_alloc&) { // the case is complete
}

/// On the root of the team.
void Worker::record(const PlannedCase& planned, const std::string& reason, storage::Cause cause) {
    counters_.fetch_add(failed, 1);
    try {
        report(fmt::format("case {} failed: {}", planned.id, reason));
        journal_.failed(planned.id, reason, cause);
        record_failure(planned, reason);
    } catch (const std::exception& error) {
        progress_.report(fmt::format("and this could not be recorded: {}", error.what()));
    }
    if (list_.arguments.fail_fast) give_up();
    if (cause != storage::Cause::files) return;
    counters_.fetch_add(failed_files, 1);
    last_folder_ = {}; // now
    look_for_folder();
    if (counters_.read(folder_removed) == 0 &&
        ++file_failures_in_a_row_ == most_file_failures_in_a_row) {
        progress_.report(
            fmt::format("file errors ended {} cases in a row; no further case is started",
                        most_file_failures_in_a_row));
        give_up();
    }
}

/// A folder that is removed while files are written keeps some of them: only a missing plan shows
/// this.
void Worker::look_for_folder() {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_folder_ < 500ms) return;
    last_folder_ = now;
    if (!list_.folder.has_lost_plan()) return;
    counters_.fetch_add(folder_removed, 1);
    give_up();
}

void Worker::give_up() {
    counters_.fetch_add(given_up, 1);
    counters_.fetch_add(stopping, 1);
}

/// Keeps what is needed to examine the case: reason, log, inputs, and the command that retries it.
void Worker::record_failure(const PlannedCase& planned, const std::string& reason) const {
    storage::make_directory(list_.folder.failure(planned.id).parent_path());
    RunArguments again = list_.arguments;
    again.only = {planned.id};
    std::string text =
        fmt::format("case {} failed at {} on {}, {} ranks, shearwake {}\nreason: {}\n"
                    "to retry: {} --retry-failed\n\nlog:\n",
                    planned.id, storage::timestamp(), storage::host_name(), team_.size(),
                    pipeline::program_git_id(), reason, run_command_line(again));
    for (const std::string& line : case_log_)
        text += "  " + line + "\n";
    text += fmt::format("\nsettings:\n{}\n\ncase (SI):\n{}",
                        storage::settings_text(planned.settings), canonical_text(planned.physics));
    storage::write_file(list_.folder.failure(planned.id), text);
}

void Worker::report(const std::string& text) {
    case_log_.push_back(storage::timestamp() + " " + text);
    progress_.report(text);
}

/// Whether the root of any team has received a signal, the time limit is reached, or there is a
/// STOP file. Roots call this between the steps of a case, so it reads the memory of rank 0 only
/// every 50 ms.
bool Worker::stop_asked() {
    const auto now = std::chrono::steady_clock::now();
    bool is_asked = stop_requested() || list_.deadline.left_s() <= 0.0;
    if (world_.is_root() && now - last_stop_file_ > 500ms) {
        last_stop_file_ = now;
        std::error_code ignored;
        is_asked = is_asked || std::filesystem::exists(list_.folder.stop_file(), ignored);
    }
    if (is_asked && !signal_reported_) {
        signal_reported_ = true;
        counters_.fetch_add(signalled, 1);
    }
    if (!signal_seen_ && now - last_look_ > 50ms) {
        last_look_ = now;
        signal_seen_ = counters_.read(signalled) > 0;
    }
    return signal_reported_ || signal_seen_;
}

void Worker::show_share(double share) {
    const long ppm = std::lround(1e6 * share);
    counters_.fetch_add(partial_ppm, ppm - partial_ppm_);
    partial_ppm_ = ppm;
    tick();
}

void Worker::tick() {
    if (!world_.is_root()) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_tick_ < 50ms) return;
    last_tick_ = now;
    stop_asked(); // looks for the STOP file on behalf of the other teams
    SweepCounts counts{.total =
                           static_cast<long>(list_.work.cases.size()) - counters_.read(elsewhere),
                       .done = counters_.read(done),
                       .failed = counters_.read(failed)};
    counts.running = counters_.read(begun) - counts.done - counts.failed;
    const auto work = static_cast<double>(counters_.read(work_done));
    counts.left_s = time_left_s(seconds_since(began_), work,
                                work + static_cast<double>(counters_.read(work_left)));
    counts.partial = 1e-6 * static_cast<double>(counters_.read(partial_ppm));
    progress_.update(counts);
}

WorkResult Worker::wait_for_others() {
    while (world_.is_root() && counters_.read(teams_ended) < list_.work.layout.teams) {
        tick();
        std::this_thread::sleep_for(20ms);
    }
    world_.barrier();
    record_rates();
    last_tick_ = {}; // so that the final progress is printed
    tick();
    const auto of = [&](Shared which) {
        return world_.broadcast(world_.is_root() ? counters_.read(which) : 0);
    };
    const std::vector<double> computed = world_.gather(computed_);
    return {.done = of(done),
            .failed = of(failed),
            .failed_files = of(failed_files),
            .postponed = of(postponed),
            .elsewhere = of(elsewhere),
            .asked_to_stop = of(signalled) != 0,
            .given_up = of(given_up) != 0,
            .folder_removed = of(folder_removed) != 0,
            .computed = {computed.begin(), computed.end()}};
}

} // namespace shearwake::schedule
