// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/plan.hpp"
#include "cost/case_costs.hpp"
#include "engines/engine.hpp"
#include "parallel/shared_counters.hpp"
#include "pipeline/run_case.hpp"
#include "schedule/deadline.hpp"
#include "schedule/learned_times.hpp"
#include "schedule/output_folder.hpp"
#include "schedule/progress.hpp"
#include "schedule/run_arguments.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/run_lock.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace shearwake::schedule {

/// What a run has to do, and where. Refers to what its maker keeps.
struct WorkList {
    const std::vector<const PlannedCase*>& cases; // in the order in which they begin
    const std::vector<std::size_t>& numbers;      // their places in the plan
    const pipeline::JobFacts& facts;
    const OutputFolder& folder;
    std::string part; // of the sweep: names journal, index and lock
    const RunArguments& arguments;
    cost::CaseCosts& costs;
    const Deadline& deadline;
    int teams = 1, ranks_per_case = 1;
};

/// What became of it. The same on all ranks.
struct WorkResult {
    long done = 0;
    long failed = 0;            // all
    long failed_files = 0;      // of them by files and disks
    long put_off = 0;           // would not have ended in time
    long elsewhere = 0;         // another run is at work on them, or has ended them meanwhile
    bool asked_to_stop = false; // by a signal, the STOP file, or the time
    bool given_up = false;      // after failures of files, or the first failure of all
    bool folder_gone = false;
    std::vector<std::size_t> computed; // places in the plan of the cases that are done; on rank 0
    storage::RunTimes times;
};

/// One team at work: takes cases from a counter that all teams share until there are none, until
/// the time is up or a stop is asked for.
class Worker {
public:
    /// Collective over the world. `learned`: what earlier runs have taken.
    Worker(const WorkList& list, const storage::JournalContents& learned, const Comm& world,
           const Comm& team, Progress& progress);

    void work();
    /// Rank 0 goes on telling while the other teams finish. Collective over the world.
    WorkResult wait_for_others();

private:
    /// Counters of all teams; times in microseconds.
    enum Shared {
        next_case,
        done,
        failed,
        failed_files,
        begun,
        stopping,
        signalled,
        given_up,
        teams_ended,
        put_off,
        elsewhere,
        folder_gone,
        teams_us,
        solves_us,
        shared_count
    };

    long next();
    bool claim(std::size_t place);
    bool in_time(std::size_t index);
    /// With what the team's last case does not share with it.
    double estimated_s(const PlannedCase& planned) const;
    bool one_case(const PlannedCase& planned);
    bool compute(const PlannedCase& planned);
    void tell(const PlannedCase& planned, const engines::SolverReport& solver);
    void record(const PlannedCase& planned, const std::string& reason, storage::Blame blame);
    void give_up(); // no further cases are begun
    void keep_failure(const PlannedCase& planned, const std::string& reason) const;
    void say(const std::string& text);
    bool stop_asked();
    void look_for_folder();
    void tick();

    WorkList list_;
    const Comm& world_;
    const Comm& team_;
    Progress& progress_;
    std::string host_; // empty: rank 0's
    storage::Journal journal_;
    std::optional<storage::CaseClaims> claims_; // of the team's root
    SharedCounters counters_;
    LearnedTimes times_;
    std::size_t at_ = 0; // place in the list of the case at work
    std::unique_ptr<engines::Engine> engine_;
    const Case* before_ = nullptr;      // the team's last case: shares with the next one
    std::vector<std::string> case_log_; // what was said of the case at work
    std::set<std::string> told_;        // notes of engines
    int file_failures_in_a_row_ = 0;
    std::vector<double> computed_; // places in the plan; of the team's root
    long worked_us_ = 0;           // this team, from its first look for a case to its last
    std::chrono::steady_clock::time_point last_tick_{}, last_look_{}, last_stop_file_{},
        last_folder_{};
    bool signal_told_ = false, signal_seen_ = false;
};

} // namespace shearwake::schedule
