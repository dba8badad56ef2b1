// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "schedule/run/run_state.hpp"
#include "storage/journal/journal.hpp"

#include <set>
#include <string>
#include <vector>

namespace shearwake::schedule {

/// Reports the cases of one team: on the terminal, in the journal and in the files of failures. Not
/// collective except for the construction.
class CaseReporter {
public:
    /// Collective over the world.
    CaseReporter(const WorkList& list, RunState& state, const Comm& world, const Comm& team,
                 Progress& progress);

    const storage::Journal& journal() const { return journal_; }
    /// Forgets the messages of the previous case.
    void begin_case() { case_log_.clear(); }
    /// Prints a message about the running case, and keeps it for the file of a failure.
    void report(const std::string& text);
    /// Prints a message unless the run is quiet.
    void inform(const std::string& text);
    /// Records a complete case in journal and index. On the root of the team.
    void record_completed(const PlannedCase& planned, const pipeline::CaseOutcome& outcome);
    /// Prints the warnings that the computation of the case has added and, if requested, its
    /// iterations and choices; each text once, and of warnings that differ in their numbers only
    /// the first one unless the run is verbose.
    void report_completed(const PlannedCase& planned, const pipeline::CaseOutcome& outcome);
    /// Counts and records a failed case, and gives up after several file errors in a row. On the
    /// root of the team.
    void record_failed(const PlannedCase& planned, const std::string& reason, storage::Cause cause);
    void end_file_failures() { file_failures_in_a_row_ = 0; }

private:
    void write_failure(const PlannedCase& planned, const std::string& reason) const;

    const WorkList& list_;
    RunState& state_;
    const Comm& team_;
    Progress& progress_;
    std::string host_; // empty: the host of rank 0
    storage::Journal journal_;
    std::vector<std::string> case_log_; // messages about the running case
    std::set<std::string> reported_;    // each is reported once
    int file_failures_in_a_row_ = 0;
};

} // namespace shearwake::schedule
