// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "parallel/shared_counters.hpp"
#include "pipeline/run_case.hpp"
#include "schedule/cost/case_costs.hpp"
#include "schedule/run/arrangement.hpp"
#include "schedule/run/deadline.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/progress.hpp"
#include "schedule/run/run.hpp"

#include <filesystem>
#include <optional>
#include <string>

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

/// What the teams of a run share: how far it is, and whether it should stop. Not collective except
/// for the construction.
class RunState {
public:
    /// Counters of all teams.
    enum Counter {
        next_portion,
        done,
        failed,       // for any reason, also in another run since this one began
        failed_files, // because of files or disks
        begun,
        stopping, // no further case is started
        signalled,
        given_up,
        teams_ended,
        postponed, // would not have finished in time
        elsewhere, // completed by another run since this one began
        folder_removed,
        partial_ppm, // sum of the complete shares of the running cases, in millionths
        work_done,   // in this run, in units of engines::Resources
        work_left,
        counter_count
    };

    /// Collective over the world.
    RunState(const WorkList& list, const Comm& world, Progress& progress);

    void start_clock() { began_ = Clock::now(); }
    long add(Counter which, long amount = 1) { return counters_.fetch_add(which, amount); }
    long read(Counter which) { return counters_.read(which); }

    /// Counts the complete share of a case of this team for the remaining time. Work before the
    /// first share of a resumed case does not show the speed of this run.
    void count_work(std::size_t place, double share);
    /// How the case of a team ends in this run: it is complete; it failed, was saved or is not
    /// begun; or another run has taken it over, and it may have to be computed after all.
    enum class CaseEnd { complete, left_out, deferred };
    /// Ends the counts of a case for the remaining time.
    void end_case(std::size_t place, CaseEnd end);
    /// Shares the complete part of the running case with the other teams. On the root of the team.
    void show_share(double share);
    /// Seconds per unit of work so far; nothing before any is done.
    std::optional<double> pace_s();

    /// Whether the root of any team has received a signal, the time limit is reached, or there is a
    /// STOP file. Roots call this between the steps of a case, so it reads the memory of rank 0
    /// only every 50 ms.
    bool stop_asked();
    void give_up(); // no further case is started
    enum class Look { soon, now };
    /// Gives up if the folder has been removed.
    void look_for_folder(Look when);
    /// Passes the progress on, on rank 0.
    void tick();
    /// Passes the last progress on, whenever the one before was.
    void last_tick();

private:
    const WorkList& list_;
    const Comm& world_;
    Progress& progress_;
    SharedCounters counters_;
    Clock::time_point began_ = Clock::now();
    std::optional<long> counted_work_; // of the running case; nothing before a resumed one reports
    long partial_ppm_ = 0;             // complete share of the running case of this team
    Clock::time_point last_tick_{}, last_look_{}, last_stop_file_{}, last_folder_{};
    bool signal_reported_ = false, signal_seen_ = false;
};

} // namespace shearwake::schedule
