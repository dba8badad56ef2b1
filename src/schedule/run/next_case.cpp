// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/cost/rates.hpp"
#include "schedule/run/worker.hpp"
#include "storage/case_file/case_file_reader.hpp"
#include "storage/case_file/case_file_writer.hpp"

#include <fmt/format.h>
#include <thread>

// How a team finds its next case.
namespace shearwake::schedule {
namespace {

using namespace std::chrono_literals;

/// Factor on the estimated time of a case, so that no case is started that cannot finish in time.
constexpr double allowance = 1.2;

bool is_newer(const std::filesystem::path& file, std::filesystem::file_time_type time) {
    std::error_code error;
    const auto written = std::filesystem::last_write_time(file, error);
    return !error && written >= time;
}

} // namespace

/// The next case for this team, or no_case, or no_case_yet while other runs compute the cases that
/// are left. Called on the root of the team.
long Worker::next() {
    std::vector<std::size_t> refused;
    long found = no_case;
    while (found == no_case) {
        look_for_folder();
        if (stop_asked()) counters_.fetch_add(stopping, 1);
        if (counters_.read(stopping) != 0) return no_case;
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
            if (answer == Claim::ended) leave_out(*place);
        } catch (const std::exception& error) { // the file system fails, or memory is lacking
            counters_.fetch_add(begun, 1);
            record(*list_.work.cases[*place], error.what(), storage::Cause::files);
            leave_out(*place);
        }
    }
    deferred_.insert(deferred_.end(), refused.rbegin(), refused.rend());
    return found == no_case && !deferred_.empty() ? no_case_yet : found;
}

/// The next position in the portions; nothing when all of them are taken.
std::optional<std::size_t> Worker::next_in_portions() {
    if (portion_ == portion_end_) {
        const std::vector<std::size_t>& all = list_.work.portions;
        const auto taken = static_cast<std::size_t>(counters_.fetch_add(next_portion, 1));
        if (taken >= all.size()) return std::nullopt;
        portion_ = all[taken];
        portion_end_ = taken + 1 < all.size() ? all[taken + 1] : list_.work.cases.size();
    }
    return portion_++;
}

/// Reserves a case for this team, if it can be begun now and no other run computes it or has
/// computed it since this run began. On the root of the team.
Worker::Claim Worker::claim(std::size_t place) {
    const PlannedCase& planned = *list_.work.cases[place];
    if (!in_time(place)) {
        if (!has_ended_elsewhere(planned)) counters_.fetch_add(postponed, 1);
        return Claim::ended;
    }
    const storage::CaseClaims::Answer answer = claims_->claim(planned.id);
    if (answer == storage::CaseClaims::Answer::refused) return Claim::deferred;
    if (has_ended_elsewhere(planned)) { // before it was released
        claims_->release(planned.id);
        return Claim::ended;
    }
    if (answer == storage::CaseClaims::Answer::inherited ||
        pipeline::has_checkpoint(list_.folder.checkpoints(planned.id)))
        storage::inherit_part(list_.folder.case_file(planned.id));
    return Claim::granted;
}

/// Whether another run has completed a case, or failed to, since this run began. Other runs may
/// still be able to compute a case that failed because of files. On the root of the team.
bool Worker::has_ended_elsewhere(const PlannedCase& planned) {
    // A file that has got its name since is complete; others are verified.
    const std::filesystem::path file = list_.folder.case_file(planned.id);
    std::error_code error;
    const auto written = std::filesystem::last_write_time(file, error);
    if (!error && (written >= list_.began || storage::is_complete(file, planned.id))) {
        counters_.fetch_add(elsewhere, 1);
        return true;
    }
    if (!is_newer(list_.folder.failure(planned.id), list_.began)) return false;
    const storage::JournalContents journal = storage::read_journals(list_.folder.root);
    const auto history = journal.cases.find(planned.id);
    if (history == journal.cases.end() ||
        history->second.state != storage::CaseHistory::State::failed ||
        history->second.cause != storage::Cause::case_itself)
        return false;
    counters_.fetch_add(begun, 1);
    counters_.fetch_add(failed, 1);
    if (list_.arguments.fail_fast) give_up();
    return true;
}

/// All ranks of the team sleep, since ranks that wait for a message use their processors.
void Worker::wait() {
    if (world_.is_root() && reported_.insert("waits").second && !list_.arguments.quiet)
        progress_.report(fmt::format("waiting for {} that other runs compute",
                                     counted(deferred_.size(), "case")));
    std::this_thread::sleep_for(500ms);
    tick();
}

/// Whether a case may start now, according to its work minus the time that its checkpoint already
/// contains. Without a measured time, only the case itself can show it.
bool Worker::in_time(std::size_t index) {
    if (!list_.deadline.exists()) return true;
    const PlannedCase& planned = *list_.work.cases[index];
    const auto work = static_cast<double>(counters_.read(work_done));
    const double pace_s = // per unit of work
        work > 0.0 ? seconds_since(began_) * list_.work.layout.teams / work
                   : cost::recorded_rate_s(engine_name(planned.physics.solver)).value_or(0.0);
    const double needed_s = allowance * list_.work.work[index] * pace_s;
    const double before = pipeline::seconds_saved(list_.folder.checkpoints(planned.id),
                                                  {planned.id, pipeline::program_git_id()});
    return list_.deadline.lets_begin(needed_s - before);
}

} // namespace shearwake::schedule
