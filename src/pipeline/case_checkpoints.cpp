// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/case_checkpoints.hpp"

#include "base/error.hpp"
#include "parallel/agree.hpp"
#include "pipeline/run_case.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::pipeline {
namespace {

namespace fs = std::filesystem;
/// Ranks that share cores lose milliseconds at every synchronisation, so this is not done at every
/// step.
constexpr double between_looks_s = 0.1;
/// After a stop request, a case without checkpoints may compute for this time, so that short cases
/// are completed.
constexpr double grace_s = 10.0;

std::array<fs::path, 2> paths_of(const fs::path& stem) {
    return {stem.string() + ".A.h5", stem.string() + ".B.h5"};
}

/// The number of steps in a checkpoint, for the journal.
long steps_in(double step) {
    return std::lround(step);
}

} // namespace

CaseCheckpoints::CaseCheckpoints(fs::path stem, storage::CheckpointOwner owner,
                                 CheckpointSchedule schedule, const Comm& team,
                                 const storage::Journal& journal, CheckpointHooks hooks)
    : stem_(std::move(stem)), owner_(std::move(owner)), schedule_(schedule), team_(team),
      journal_(journal), hooks_(std::move(hooks)), began_(Clock::now()), saved_(began_),
      looked_(began_), stop_question_(team, between_looks_s) {
    find_newest();
    if (newest_) earlier_seconds_ = newest_->facts.seconds;
}

void CaseCheckpoints::find_newest() {
    may_have_files_ = team_.broadcast(team_.is_root() && fs::exists(stem_.parent_path()));
    if (!may_have_files_) return;
    const auto paths = paths_of(stem_);
    for (std::size_t i = 0; i < paths.size(); ++i) {
        bool is_usable = false; // according to rank 0, which checks the files
        storage::CheckpointFacts facts;
        on_root(team_, [&] {
            if (!fs::exists(paths[i])) return;
            const std::string reason = storage::checkpoint_error(paths[i], owner_, facts);
            is_usable = reason.empty();
            if (!is_usable)
                hooks_.report(
                    fmt::format("checkpoint {} {}: it is not used", paths[i].string(), reason));
        });
        if (!team_.broadcast(is_usable)) continue;
        facts.sequence = team_.broadcast(facts.sequence);
        facts.seconds = team_.sum(team_.is_root() ? facts.seconds : 0.0);
        if (!newest_ || newest_->facts.sequence <= facts.sequence) newest_ = {paths[i], facts};
    }
}

CaseCheckpoints::Answer CaseCheckpoints::decide() const {
    if (!stop_failed_ && hooks_.stop_asked()) return Answer::save_and_stop;
    const bool enough_steps = schedule_.steps > 0 && steps_ >= schedule_.steps;
    const bool late = schedule_.interval_s > 0.0 && seconds_since(saved_) >= schedule_.interval_s;
    return enough_steps || late ? Answer::save : Answer::resume;
}

long CaseCheckpoints::steps_to_next_look() const {
    const double step_s = seconds_since(looked_) / static_cast<double>(steps_ - last_look_);
    const long by_clock = static_cast<long>(std::clamp(between_looks_s / step_s, 1.0, 1e6));
    if (schedule_.steps == 0) return by_clock;
    return std::clamp(schedule_.steps - steps_, 1L, by_clock);
}

bool CaseCheckpoints::due() {
    ++steps_;
    if (steps_ < next_look_) return false;
    // Clocks and signals differ between ranks, so the root decides, also when to check again.
    long answer = 0, wait = 0;
    if (team_.is_root()) {
        answer = static_cast<long>(decide());
        wait = steps_to_next_look();
    }
    answer = team_.broadcast(answer);
    next_look_ = steps_ + team_.broadcast(wait);
    last_look_ = steps_;
    looked_ = Clock::now();
    stopping_ = static_cast<Answer>(answer) == Answer::save_and_stop;
    return static_cast<Answer>(answer) != Answer::resume;
}

void CaseCheckpoints::progressed(double share) {
    if (!team_.is_root() || !hooks_.progressed) return;
    const auto now = Clock::now();
    if (now - progressed_ < std::chrono::milliseconds(250)) return;
    progressed_ = now;
    hooks_.progressed(share);
}

void CaseCheckpoints::save(const std::function<void(StateWriter&)>& write) {
    const Comm::Unwatched writing;
    may_have_files_ = true;
    const auto paths = paths_of(stem_);
    const fs::path& path = newest_ && newest_->path == paths[0] ? paths[1] : paths[0];
    storage::CheckpointFacts facts{.sequence = newest_ ? newest_->facts.sequence + 1 : 1,
                                   .seconds = earlier_seconds_ + seconds_since(began_),
                                   .part = {}};
    std::string reason;
    std::optional<State> saved; // assigned to newest_ on all ranks or on none
    try {
        fail_together_with_files(team_, [&] {
            storage::CheckpointFileWriter file(path, team_);
            write(file);
            if (part_) facts.part = part_();
            saved = {path, facts};
            file.commit(owner_, facts);
            on_root(team_,
                    [&] { journal_.checkpointed(owner_.case_id, steps_in(file.scalar("step"))); });
        });
        newest_.swap(saved);
    } catch (const CaseFailure& failure) {
        reason = failure.what();
    } catch (const UsageError& failure) { // the file system reports an error
        reason = failure.what();
    }
    if (!reason.empty() && team_.is_root())
        hooks_.report(
            fmt::format("case {} continues without a checkpoint: {}", owner_.case_id, reason));
    // Without a checkpoint, a stop is delayed until the end of the case.
    if (stopping_) (reason.empty() ? stops_ : stop_failed_) = true;
    next_look_ = std::max(1L, next_look_ - steps_);
    if (schedule_.steps > 0) next_look_ = std::min(next_look_, schedule_.steps);
    steps_ = last_look_ = 0;
    saved_ = looked_ = Clock::now();
}

bool CaseCheckpoints::stop_asked() {
    stops_ = stop_question_.ask([this] {
        if (!stop_seen_ && hooks_.stop_asked()) stop_seen_ = Clock::now();
        return stop_seen_ && seconds_since(*stop_seen_) > grace_s;
    });
    return stops_;
}

bool CaseCheckpoints::restore(const std::function<void(const StateReader&)>& read) {
    if (!newest_) return false;
    fail_together_with_files(team_, [&] {
        storage::CheckpointFileReader file(newest_->path, team_);
        read(file);
        const long steps = steps_in(file.get("step"));
        file.close();
        on_root(team_, [&] { journal_.resumed(owner_.case_id, steps); });
    });
    return true;
}

void CaseCheckpoints::discard() {
    if (may_have_files_) on_root(team_, [&] { remove_checkpoints(stem_); });
    newest_.reset();
    earlier_seconds_ = 0.0;
}

bool has_checkpoint(const fs::path& stem) {
    return fs::exists(stem.parent_path()) &&
           std::ranges::any_of(paths_of(stem),
                               [](const fs::path& path) { return fs::exists(path); });
}

double seconds_saved(const fs::path& stem, const storage::CheckpointOwner& owner) {
    double most = 0.0;
    for (const fs::path& path : paths_of(stem)) {
        storage::CheckpointFacts facts;
        if (fs::exists(path) && storage::checkpoint_error(path, owner, facts).empty())
            most = std::max(most, facts.seconds);
    }
    return most;
}

void remove_checkpoints(const fs::path& stem) {
    std::error_code ignored; // also where no case has ever written one
    for (const std::string& name : storage::names_in(stem.parent_path()))
        for (const fs::path& path : paths_of(stem)) // and the parts that a killed run has left
            if (name.starts_with(path.filename().string()))
                fs::remove(stem.parent_path() / name, ignored);
}

} // namespace shearwake::pipeline
