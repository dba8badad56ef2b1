// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "engines/checkpoint.hpp"
#include "parallel/comm.hpp"
#include "parallel/shared_counters.hpp"
#include "storage/checkpoint/checkpoint_file.hpp"
#include "storage/journal/journal.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::pipeline {

/// When a run saves checkpoints of running cases.
struct CheckpointSchedule {
    double interval_s = 300.0; // 0: only when a stop is requested
    long steps = 0;            // additionally after this number of steps; 0: never
};

/// Callbacks to the run, called only on the root of the team.
struct CheckpointHooks {
    std::function<bool()> stop_asked;
    std::function<void(const std::string&)> report;
    /// The share of the steps that are complete, 0 to 1; at most four times per second.
    std::function<void(double)> progressed = {};
};

/// `<stem>.A.h5` and `<stem>.B.h5`, written alternately, so that one remains valid if the program
/// ends while writing the other. Every member is collective over the team unless it says otherwise.
class CaseCheckpoints : public engines::Checkpoints {
public:
    /// Finds the newest checkpoint that is complete, undamaged and belongs to the owner; reports
    /// the ones that it rejects.
    CaseCheckpoints(std::filesystem::path stem, storage::CheckpointOwner owner,
                    CheckpointSchedule schedule, const Comm& team, const storage::Journal& journal,
                    CheckpointHooks hooks);

    bool due() override;
    void save(const std::function<void(StateWriter&)>& write) override;
    bool restore(const std::function<void(const StateReader&)>& read) override;
    bool stop() const override { return stops_; } // not collective
    bool stop_asked() override;
    void progressed(double share) override;

    /// Whether a checkpoint was found or saved. Not collective.
    bool has_state() const { return newest_.has_value(); }
    /// The record of the unfinished case file in the newest checkpoint; on the root. Not
    /// collective.
    std::string part_record() const { return newest_ ? newest_->facts.part : ""; }
    /// Called at every save on all ranks, after the checkpoint is written.
    void store_with(std::function<std::string()> part_record) { part_ = std::move(part_record); }
    /// Removes the checkpoints, when the case is complete or starts from scratch.
    void discard();
    /// Reports a message to the user, on the root. Not collective.
    void report(const std::string& text) const { hooks_.report(text); }
    /// Seconds for which earlier runs have computed the case. Not collective.
    double earlier_seconds() const { return earlier_seconds_; }

private:
    enum class Answer : long { resume, save, save_and_stop };
    struct State {
        std::filesystem::path path;
        storage::CheckpointFacts facts;
    };

    void find_newest();
    Answer decide() const;
    long steps_to_next_look() const;

    std::filesystem::path stem_;
    storage::CheckpointOwner owner_;
    CheckpointSchedule schedule_;
    const Comm& team_;
    const storage::Journal& journal_;
    CheckpointHooks hooks_;
    std::function<std::string()> part_;
    std::optional<State> newest_;
    double earlier_seconds_ = 0.0;
    bool may_have_files_ = false;
    Clock::time_point began_, saved_, looked_, progressed_;
    // Relative to the last save; the root checks its clock and signals at next_look_.
    long steps_ = 0, last_look_ = 0, next_look_ = 1;
    bool stopping_ = false, stops_ = false, stop_failed_ = false;
    SpacedQuestion stop_question_;
    std::optional<Clock::time_point> stop_seen_; // on the root
};

/// Whether a file of a checkpoint exists, which may be damaged. Not collective.
bool has_checkpoint(const std::filesystem::path& stem);

/// Seconds for which a case was computed until its newest undamaged checkpoint; 0 without one. Not
/// collective.
double seconds_saved(const std::filesystem::path& stem, const storage::CheckpointOwner& owner);

/// Not collective.
void remove_checkpoints(const std::filesystem::path& stem);

} // namespace shearwake::pipeline
