#pragma once

#include "engines/checkpoint.hpp"
#include "io/checkpoint_file.hpp"
#include "io/journal.hpp"
#include "parallel/comm.hpp"
#include "sweep/end_alone.hpp"

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace shearwake {

/// When a run saves the cases at work.
struct CheckpointSchedule {
    double interval_s = 300.0; // 0: only when a stop is asked for
    long steps = 0;            // every so many steps besides; 0: never
};

/// What the saving of a case needs of the run around it. The first two are called on the team's
/// root only.
struct CheckpointHooks {
    std::function<bool()> stop_asked;
    std::function<void(const std::string&)> say;
    EndAlone end_alone;
};

/// `<stem>.A.h5` and `<stem>.B.h5`, written in turn, so that an end while one is written leaves the
/// other. Every member is collective over the team unless it says otherwise.
class CaseCheckpoints : public Checkpoints {
public:
    /// Looks for the newest state that is whole, undamaged and the owner's; says which ones it
    /// passes over.
    CaseCheckpoints(std::filesystem::path stem, CheckpointOwner owner, CheckpointSchedule schedule,
                    const Comm& team, const Journal& journal, CheckpointHooks hooks);

    bool due() override;
    void save(const std::function<void(StateWriter&)>& write) override;
    bool restore(const std::function<void(StateReader&)>& read) override;
    bool stop() const override { return saved_for_stop_; } // not collective

    /// Whether there is a state, found or saved. Not collective.
    bool has_state() const { return newest_.has_value(); }
    /// Removes the states: the case is whole, or begins anew.
    void discard();
    /// To the user, on the root. Not collective.
    void say(const std::string& text) const { hooks_.say(text); }
    /// Seconds that earlier runs have computed the case for. Not collective.
    double earlier_seconds() const { return earlier_seconds_; }

private:
    enum class Answer : long { go_on, save, save_and_stop };
    struct State {
        std::filesystem::path path;
        CheckpointFacts facts;
    };

    void find_newest();
    Answer decide() const;
    long steps_to_next_look() const;

    std::filesystem::path stem_;
    CheckpointOwner owner_;
    CheckpointSchedule schedule_;
    const Comm& team_;
    const Journal& journal_;
    CheckpointHooks hooks_;
    std::optional<State> newest_;
    double earlier_seconds_ = 0.0;
    std::chrono::steady_clock::time_point began_, saved_, looked_;
    // Counted from the last save; the root looks at its clock and at signals at next_look_.
    long steps_ = 0, last_look_ = 0, next_look_ = 1;
    bool stopping_ = false, saved_for_stop_ = false, stop_failed_ = false;
};

/// Whether a case has a state that a run may go on from, as far as its attributes tell. Not
/// collective.
bool has_checkpoint(const std::filesystem::path& stem, const CheckpointOwner& owner);

/// Seconds that a case has been computed for until its newest state; 0 without one. Not collective.
double seconds_saved(const std::filesystem::path& stem, const CheckpointOwner& owner);

/// Not collective.
void remove_checkpoints(const std::filesystem::path& stem);

} // namespace shearwake
