// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/worker.hpp"

#include "base/text.hpp"
#include "parallel/agree.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/cost/rates.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <thread>
#include <utility>

namespace shearwake::schedule {
namespace {

using namespace std::chrono_literals;

/// Waiting times before a case that failed because of a file is tried again.
constexpr std::array waits_for_files = {1s, 5s};

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

} // namespace

Worker::Worker(const WorkList& list, const Comm& world, const Comm& team, Progress& progress)
    : list_(list), world_(world), team_(team), state_(list_, world, progress),
      reporter_(list_, state_, world, team, progress),
      queue_(list_, state_, reporter_, world, team) {
    computed_.reserve(list_.work.cases.size());
}

void Worker::work() {
    state_.start_clock();
    const TeamLayout& layout = list_.work.layout;
    if (layout.team_of(world_.rank()) == layout.teams) return; // an idle rank
    while (true) {
        long index = -1;
        if (team_.is_root()) index = queue_.next();
        index = team_.broadcast(index);
        if (index == CaseQueue::no_case) break;
        if (index == CaseQueue::no_case_yet) {
            wait();
            continue;
        }
        const std::size_t number = list_.work.numbers[static_cast<std::size_t>(index)];
        at_ = static_cast<std::size_t>(index);
        const PlannedCase& planned = *list_.work.cases[at_];
        const RunState::CaseEnd end = compute_with_retries(planned);
        if (!team_.is_root()) continue;
        state_.end_case(at_, end);
        if (end == RunState::CaseEnd::deferred) queue_.defer(at_);
        queue_.release(planned);
        if (end == RunState::CaseEnd::complete) computed_.push_back(static_cast<double>(number));
    }
    if (team_.is_root()) state_.add(RunState::teams_ended);
}

/// All ranks of the team sleep, since ranks that wait for a message use their processors.
void Worker::wait() {
    if (world_.is_root() && !std::exchange(has_waited_, true))
        reporter_.inform(fmt::format("waiting for {} that other runs compute",
                                     counted(queue_.deferred(), "case")));
    std::this_thread::sleep_for(500ms);
    state_.tick();
}

/// Their data are in the way of another engine's, or incomplete.
void Worker::free_engines() {
    list_.costs.free_engines();
    shared_.clear();
}

/// Computes a case and repeats it after a temporary failure of the file system. A failure of any
/// rank ends the attempt on all ranks of the team.
RunState::CaseEnd Worker::compute_with_retries(const PlannedCase& planned) {
    if (team_.is_root()) state_.add(RunState::begun);
    state_.tick(); // reports the estimate
    reporter_.begin_case();
    RunState::CaseEnd end = RunState::CaseEnd::left_out;
    for (std::size_t attempt = 0;; ++attempt) {
        const std::optional<CaseError> error = error_of([&] {
            fail_together(team_, [&] {
                if (compute(planned)) end = RunState::CaseEnd::complete;
            });
        });
        // A rank that lacks the memory to describe the error has to decide as the others do.
        if (!team_.any(error.has_value())) {
            reporter_.end_file_failures();
            break;
        }
        end = RunState::CaseEnd::left_out;
        free_engines();
        const bool passing = error && error->persistence == Persistence::passing;
        if (!team_.all(passing) || attempt == waits_for_files.size()) {
            if (team_.is_root() && error) {
                if (queue_.holds(planned)) {
                    reporter_.record_failed(planned, error->reason, error->cause);
                } else {
                    state_.add(RunState::begun, -1);
                    end = RunState::CaseEnd::deferred;
                }
            }
            break;
        }
        if (team_.is_root())
            reporter_.report(fmt::format("case {} is tried again in {} s: {}", planned.id,
                                         waits_for_files[attempt].count(), error->reason));
        std::this_thread::sleep_for(waits_for_files[attempt]);
    }
    before_ = &planned.physics;
    if (team_.is_root()) state_.show_share(0.0);
    return end;
}

/// Returns whether the case is complete; otherwise a checkpoint has been saved.
bool Worker::compute(const PlannedCase& planned) {
    on_root(team_, [&] { reporter_.journal().started(planned.id, team_.size()); });
    if (before_ && before_->solver.index() != planned.physics.solver.index()) free_engines();
    pipeline::CaseCheckpoints checkpoints(list_.folder.checkpoints(planned.id),
                                          {planned.id, pipeline::program_git_id()},
                                          list_.arguments.checkpoints, team_, reporter_.journal(),
                                          {[this] { return state_.stop_asked(); },
                                           [this](const auto& text) { reporter_.report(text); },
                                           [this](double share) {
                                               state_.count_work(at_, share);
                                               state_.show_share(share);
                                           }});
    if (team_.is_root() && !checkpoints.has_state()) state_.count_work(at_, 0.0);
    const auto outcome = pipeline::run_case(
        planned, list_.facts, list_.costs.engine_of(planned.physics), team_,
        list_.folder.case_file(planned.id), checkpoints, [this] { state_.tick(); });
    if (!outcome) {
        if (team_.is_root()) state_.add(RunState::begun, -1);
        return false;
    }
    on_root(team_, [&] { reporter_.record_completed(planned, *outcome); });
    reporter_.report_completed(planned, *outcome);
    if (!team_.is_root()) return true;
    add_rate(planned, *outcome);
    state_.add(RunState::done);
    return true;
}

void Worker::add_rate(const PlannedCase& planned, const pipeline::CaseOutcome& outcome) {
    const engines::Resources& needs = outcome.needs;
    if (!outcome.is_resumed) {
        Measured& all = measured_.at(planned.physics.solver.index());
        all.core_s += outcome.seconds * std::min(team_.size(), needs.useful_ranks);
        all.work += needs.work + (needs.shared == shared_ ? 0.0 : needs.shared_work);
    }
    shared_ = needs.shared;
}

void Worker::record_rates() const {
    for (std::size_t i = 0; i < measured_.size(); ++i) {
        const double core_s = world_.sum(measured_[i].core_s), work = world_.sum(measured_[i].work);
        if (world_.is_root() && work > 0.0) cost::record_rate_s(engine_names()[i], core_s / work);
    }
}

WorkResult Worker::wait_for_others() {
    while (world_.is_root() && state_.read(RunState::teams_ended) < list_.work.layout.teams) {
        state_.tick();
        std::this_thread::sleep_for(20ms);
    }
    world_.barrier();
    record_rates();
    state_.last_tick();
    const auto broadcast_count = [&](RunState::Counter which) {
        return world_.broadcast(world_.is_root() ? state_.read(which) : 0);
    };
    const std::vector<double> computed = world_.gather(computed_);
    return {.done = broadcast_count(RunState::done),
            .failed = broadcast_count(RunState::failed),
            .failed_files = broadcast_count(RunState::failed_files),
            .postponed = broadcast_count(RunState::postponed),
            .elsewhere = broadcast_count(RunState::elsewhere),
            .asked_to_stop = broadcast_count(RunState::signalled) != 0,
            .given_up = broadcast_count(RunState::given_up) != 0,
            .folder_removed = broadcast_count(RunState::folder_removed) != 0,
            .computed = {computed.begin(), computed.end()}};
}

} // namespace shearwake::schedule
