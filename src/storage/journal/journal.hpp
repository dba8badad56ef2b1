// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shearwake::storage {

/// The cause of a failure: the case itself, or files and disks, which may be repaired.
enum class Cause { case_itself, files };

/// Data of a run that are recorded when it starts.
struct RunStart {
    std::string run; // its name: process_name() of rank 0
    int ranks = 1, teams = 1;
    std::size_t cases_left = 0;
    std::vector<std::string> overrides; // key=value
    std::string git_id;                 // git id of the program
    std::string kernels;                // the instruction set in use
    bool allow_mixed = false;           // results of another program exist and are allowed
    std::string resumed_by;             // command that resumes it; empty: `run` with its job
};

/// The journal contains one JSON object per line. Lines are only appended, each in one write, so
/// that the teams of a run need not communicate. Each line ends in its own checksum; a line that
/// was changed, or truncated by a kill, is ignored. Each run, and each additional host of a run,
/// has a separate journal, since network file systems lose lines that two hosts append at the same
/// time.
class Journal {
public:
    explicit Journal(std::filesystem::path path);

    /// Each throws UsageError (environment) when the file cannot be written. Not collective.
    void run_started(const RunStart& start) const;
    void run_ended(const std::string& how) const;
    void started(const std::string& id, int ranks) const;
    void checkpointed(const std::string& id, long step) const;
    void resumed(const std::string& id, long step) const;
    /// `seconds`: of the case over all runs, with the time to write its file. `checksum`: the last
    /// line of the case file.
    void finished(const std::string& id, double seconds, const std::string& engine,
                  const std::string& checksum = "") const;
    void failed(const std::string& id, const std::string& reason, Cause cause) const;
    /// The case file was damaged and was moved aside.
    void damaged(const std::string& id, const std::string& reason) const;

private:
    std::filesystem::path path_;
};

/// The latest state of a case in a journal.
struct CaseHistory {
    enum class State { started, finished, failed } state = State::started;
    std::string reason; // reason of the failure
    Cause cause = Cause::case_itself;
    std::string host;
    double unix_time_s = 0.0;
    double seconds = 0.0; // of a finished case, with the time to write its file
};

struct JournalContents {
    std::map<std::string, CaseHistory> cases;
    std::map<std::string, int> runs;    // teams of the runs without a recorded end, by name
    std::vector<std::string> overrides; // overrides of the last run, key=value
    std::string resumed_by;             // RunStart::resumed_by of the last run
    double unix_time_s = 0.0;           // when the last run started
    int teams = 1;                      // of the last run
    long unreadable_lines = 0;          // number of ignored lines, damaged or truncated by a kill
};

/// Empty when there is no journal. Throws UsageError (environment) when it cannot be read.
JournalContents read_journal(const std::filesystem::path& path);

/// The name of the journal of a run on a further host (empty: that of rank 0):
/// journal.node1-4711.jsonl, journal.node1-4711@node7.jsonl.
std::string journal_name(const std::string& run, const std::string& host = "");

/// Combines all journals of an output folder; for a case in several journals, the latest entry
/// counts.
JournalContents read_journals(const std::filesystem::path& folder);

std::string host_name();
/// UTC, ISO 8601, to the second.
std::string timestamp();

} // namespace shearwake::storage
