// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "parallel/shared_counters.hpp"
#include "pipeline/run_case.hpp"
#include "problem/case/plan.hpp"
#include "schedule/cost/case_costs.hpp"
#include "schedule/run/arrangement.hpp"
#include "schedule/run/deadline.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/progress.hpp"
#include "schedule/run/run.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/claims.hpp"

#include <array>
#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace shearwake::schedule {

/// The cases that a run computes, and where. The references must outlive it.
struct WorkList {
    const Arrangement& work;
    const pipeline::JobFacts& facts;
    const OutputFolder& folder;
    std::string run;                       // its name; in those of journal and index, and in claims
    std::filesystem::file_time_type began; // when the run began
    const RunArguments& arguments;
    cost::CaseCosts& costs;
    const Deadline& deadline;
};

/// The outcome of a run. Identical on all ranks.
struct WorkResult {
    long done = 0;
    long failed = 0;            // for any reason, also in another run since this one began
    long failed_files = 0;      // because of files or disks
    long postponed = 0;         // would not have finished in time
    long elsewhere = 0;         // completed by another run since this one began
    bool asked_to_stop = false; // by a signal, the STOP file or the time limit
    bool given_up = false;      // after file errors, or after any failure with --fail-fast
    bool folder_removed = false;
    std::vector<std::size_t> computed; // positions in the plan; on rank 0 only
};

/// Computes cases on one team. It takes portions of them from a counter that all teams share until
/// none is left, the time limit is reached or a stop is requested. Cases that another run computes
/// are deferred: the team waits until they are complete, and computes those that the other run
/// leaves.
class Worker {
public:
    /// Collective over the world.
    Worker(const WorkList& list, const Comm& world, const Comm& team, Progress& progress);

    void work();
    /// Rank 0 prints the progress until the other teams have finished. Collective over the world.
    WorkResult wait_for_others();

private:
    /// Counters of all teams.
    enum Shared {
        next_portion,
        done,
        failed,
        failed_files,
        begun,
        stopping,
        signalled,
        given_up,
        teams_ended,
        postponed,
        elsewhere,
        folder_removed,
        partial_ppm, // sum of the complete shares of the running cases, in millionths
        work_done,   // in this run, in units of engines::Resources
        work_left,
        shared_count
    };

    /// Instead of a position in the list of cases.
    static constexpr long no_case = -1, no_case_yet = -2;
    long next();
    std::optional<std::size_t> next_in_portions();
    enum class Claim { granted, deferred, ended };
    Claim claim(std::size_t place);
    bool has_ended_elsewhere(const PlannedCase& planned);
    void wait();
    bool in_time(std::size_t index);
    /// The case will not be computed, or not completed, in this run.
    void leave_out(std::size_t place);
    /// Counts the complete share of a case of this team for the remaining time.
    void count_work(double share);
    bool one_case(const PlannedCase& planned);
    bool compute(const PlannedCase& planned);
    /// Records the rates of the complete cases of all teams. Collective over the world.
    void record_rates() const;
    void report(const PlannedCase& planned, const pipeline::CaseOutcome& outcome);
    void record(const PlannedCase& planned, const std::string& reason, storage::Cause cause);
    void give_up(); // no further case is started
    void record_failure(const PlannedCase& planned, const std::string& reason) const;
    void report(const std::string& text);
    bool stop_asked();
    void look_for_folder();
    /// Shares the complete part of the running case with the other teams. On the root of the team.
    void show_share(double share);
    void tick();

    WorkList list_;
    const Comm& world_;
    const Comm& team_;
    Progress& progress_;
    std::string host_; // empty: the host of rank 0
    storage::Journal journal_;
    std::optional<storage::CaseClaims> claims_; // on the root of the team
    SharedCounters counters_;
    Clock::time_point began_ = Clock::now();
    /// The time and the work of complete cases of each engine, by the index of its options.
    struct Measured {
        double core_s = 0.0, work = 0.0;
    };
    std::array<Measured, std::variant_size_v<SolverOptions>> measured_{}; // on the root of the team
    std::size_t portion_ = 0, portion_end_ = 0; // the remaining cases of the portion of this team
    std::vector<std::size_t> deferred_;         // positions in the list
    std::size_t at_ = 0;                        // position of the running case in the list
    std::optional<long> counted_work_;  // of the running case; nothing before a resumed one reports
    const Case* before_ = nullptr;      // previous case of the team
    std::string shared_;                // by the data that the team has, see engines::Resources
    std::vector<std::string> case_log_; // messages about the running case
    std::set<std::string> reported_;    // each is reported once
    int file_failures_in_a_row_ = 0;
    std::vector<double> computed_; // positions in the plan; on the root of the team
    long partial_ppm_ = 0;         // complete share of the running case of this team
    std::chrono::steady_clock::time_point last_tick_{}, last_look_{}, last_stop_file_{},
        last_folder_{};
    bool signal_reported_ = false, signal_seen_ = false;
};

} // namespace shearwake::schedule
