// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/case_queue.hpp"

#include "parallel/agree.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/cost/rates.hpp"
#include "storage/case_file/case_file_reader.hpp"
#include "storage/case_file/case_file_writer.hpp"

namespace shearwake::schedule {
namespace {

/// Factor on the estimated time of a case, so that no case is started that cannot finish in time.
constexpr double allowance = 1.2;

bool is_newer(const std::filesystem::path& file, std::filesystem::file_time_type time) {
    std::error_code error;
    const auto written = std::filesystem::last_write_time(file, error);
    return !error && written >= time;
}

} // namespace

CaseQueue::CaseQueue(const WorkList& list, RunState& state, CaseReporter& reporter,
                     const Comm& world, const Comm& team)
    : list_(list), state_(state), reporter_(reporter) {
    together(world, [&] {
        if (team.is_root()) claims_.emplace(list_.folder.locks(), list_.run);
    });
}

long CaseQueue::next() {
    std::vector<std::size_t> refused;
    long found = no_case;
    while (found == no_case) {
        state_.look_for_folder(RunState::Look::soon);
        if (state_.stop_asked()) state_.add(RunState::stopping);
        if (state_.read(RunState::stopping) != 0) return no_case;
        std::optional<std::size_t> place = next_in_portions();
        const bool is_first_try = place.has_value();
        if (!place && deferred_.empty()) break;
        if (!place) { // in reverse, since the other run computes its portion in order
            place = deferred_.back();
            deferred_.pop_back();
        }
        try {
            const Claim answer = claim(*place);
            if (answer == Claim::granted) found = static_cast<long>(*place);
            if (answer == Claim::deferred) (is_first_try ? deferred_ : refused).push_back(*place);
            if (answer == Claim::deferred) // the other run computes the rest of its portion as well
                for (; portion_ < portion_end_; ++portion_)
                    deferred_.push_back(portion_);
            if (answer == Claim::ended) state_.end_case(*place, RunState::CaseEnd::left_out);
        } catch (const std::exception& error) { // the file system fails, or memory is lacking
            state_.add(RunState::begun);
            reporter_.record_failed(*list_.work.cases[*place], error.what(), storage::Cause::files);
            state_.end_case(*place, RunState::CaseEnd::left_out);
        }
    }
    deferred_.insert(deferred_.end(), refused.rbegin(), refused.rend());
    return found == no_case && !deferred_.empty() ? no_case_yet : found;
}

/// The next position in the portions; nothing when all of them are taken.
std::optional<std::size_t> CaseQueue::next_in_portions() {
    if (portion_ == portion_end_) {
        const std::vector<std::size_t>& firsts = list_.work.portions;
        const auto portion = static_cast<std::size_t>(state_.add(RunState::next_portion));
        if (portion >= firsts.size()) return std::nullopt;
        portion_ = firsts[portion];
        portion_end_ = portion + 1 < firsts.size() ? firsts[portion + 1] : list_.work.cases.size();
    }
    return portion_++;
}

/// Reserves a case for this team, if it can be begun now and no other run computes it or has
/// computed it since this run began.
CaseQueue::Claim CaseQueue::claim(std::size_t place) {
    const PlannedCase& planned = *list_.work.cases[place];
    if (!in_time(place)) {
        if (!count_if_ended_elsewhere(planned)) state_.add(RunState::postponed);
        return Claim::ended;
    }
    const storage::CaseClaims::Answer answer = claims_->claim(planned.id);
    if (answer == storage::CaseClaims::Answer::refused) return Claim::deferred;
    if (count_if_ended_elsewhere(planned)) { // before it was released
        claims_->release(planned.id);
        return Claim::ended;
    }
    if (answer == storage::CaseClaims::Answer::inherited ||
        pipeline::has_checkpoint(list_.folder.checkpoints(planned.id)))
        storage::inherit_part(list_.folder.case_file(planned.id));
    return Claim::granted;
}

/// Whether another run has completed a case, or failed to, since this run began; counts it then.
/// Other runs may still be able to compute a case that failed because of files.
bool CaseQueue::count_if_ended_elsewhere(const PlannedCase& planned) {
    // A file that has got its name since is complete; others are verified.
    const std::filesystem::path file = list_.folder.case_file(planned.id);
    std::error_code error;
    const auto written = std::filesystem::last_write_time(file, error);
    if (!error && (written >= list_.began || storage::is_complete(file, planned.id))) {
        state_.add(RunState::elsewhere);
        return true;
    }
    if (!is_newer(list_.folder.failure(planned.id), list_.began)) return false;
    const storage::JournalContents journal = storage::read_journals(list_.folder.root);
    const auto history = journal.cases.find(planned.id);
    if (history == journal.cases.end() ||
        history->second.state != storage::CaseHistory::State::failed ||
        history->second.cause != storage::Cause::case_itself)
        return false;
    state_.add(RunState::begun);
    state_.add(RunState::failed);
    if (list_.arguments.fail_fast) state_.give_up();
    return true;
}

/// Whether a case may start now, according to its work minus the time that its checkpoint already
/// contains. Without a measured time, only the case itself can show it.
bool CaseQueue::in_time(std::size_t place) {
    if (!list_.deadline.exists()) return true;
    const PlannedCase& planned = *list_.work.cases[place];
    const std::optional<double> recorded_s =
        cost::recorded_rate_s(engine_name(planned.physics.solver));
    const double pace_s = state_.pace_s().value_or(recorded_s.value_or(0.0)); // per unit of work
    const double needed_s = allowance * list_.work.work[place] * pace_s;
    const double before = pipeline::seconds_saved(list_.folder.checkpoints(planned.id),
                                                  {planned.id, pipeline::program_git_id()});
    return list_.deadline.lets_begin(needed_s - before);
}

} // namespace shearwake::schedule
