#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shearwake {

/// Whose fault a failure is: the case's own, or that of files and disks, which may be mended.
enum class Blame { case_itself, files };

/// What a run says of itself when it begins.
struct RunStart {
    int ranks = 1, teams = 1;
    std::size_t cases_left = 0;
    std::vector<std::string> overrides; // key=value
    std::string git_id;                 // of the program
    bool allow_mixed = false;           // results of another program are there, and allowed
};

/// What a computation took, beside what it was expected to take.
struct CaseTimes {
    double seconds = 0.0;           // over all runs
    double estimated_seconds = 0.0; // by the engine, uncorrected, on these ranks
    std::string engine;
};

/// Where the time of a run went. Of its cases' solves alone, not their files.
struct RunTimes {
    double idle_share = 0.0;     // of the teams, waiting for the last one to end
    double beside_solve_s = 0.0; // a case, on its team: claim, journal, file, table's numbers
};

/// The journal: one JSON object a line, only ever appended to, a line in one write, so that the
/// teams of a run need not talk to each other. A line cut short by a kill is passed over. Each
/// shard, and each host of a run beside that of rank 0, has a journal of its own: network file
/// systems lose lines that two hosts append at once.
class Journal {
public:
    explicit Journal(std::filesystem::path path);

    /// Each throws UsageError (environment) when the file cannot be written. Not collective.
    void run_started(const RunStart& start) const;
    void run_ended(const std::string& how, const RunTimes& times) const;
    void started(const std::string& id, int ranks) const;
    void checkpointed(const std::string& id, long step) const;
    void resumed(const std::string& id, long step) const;
    void finished(const std::string& id, const CaseTimes& times) const;
    void failed(const std::string& id, const std::string& reason, Blame blame) const;

private:
    std::filesystem::path path_;
};

/// The latest that a journal says of a case.
struct CaseHistory {
    enum class State { started, finished, failed } state = State::started;
    std::string reason; // of the failure
    Blame blame = Blame::case_itself;
    CaseTimes times; // of the last finished computation
    std::string host;
    double unix_time_s = 0.0;
};

struct JournalContents {
    std::map<std::string, CaseHistory> cases;
    bool running = false;       // a run has started and none has said since that it ended
    std::string last_run_ended; // how
    RunTimes last_run_times;
    std::vector<std::string> overrides; // of the last run, key=value
    double unix_time_s = 0.0;           // when the last run started
};

/// Empty when there is no journal. Throws UsageError (environment) when it cannot be read.
JournalContents read_journal(const std::filesystem::path& path);

/// The name of the journal of a part of a sweep (empty: all of it) on a further host of the run
/// (empty: rank 0's): journal.jsonl, journal.2-of-8.jsonl, journal.2-of-8@node7.jsonl.
std::string journal_name(const std::string& part, const std::string& host = "");

/// All journals of an output folder as one: of a case that several speak of, the latest word.
JournalContents read_journals(const std::filesystem::path& folder);

std::string host_name();
/// UTC, ISO 8601, to the second.
std::string timestamp();

} // namespace shearwake
