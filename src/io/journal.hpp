#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shearwake {

/// The journal: one JSON object a line, only ever appended to, a line in one write, so that the
/// teams of a run need not talk to each other. A line cut short by a kill is passed over.
class Journal {
public:
    explicit Journal(std::filesystem::path path);

    /// Each throws UsageError (environment) when the file cannot be written. Not collective.
    void run_started(int ranks, int teams, std::size_t cases_left,
                     const std::vector<std::string>& overrides) const;
    void run_ended(const std::string& how) const;
    void started(const std::string& id, int ranks) const;
    void checkpointed(const std::string& id, long step) const;
    void resumed(const std::string& id, long step) const;
    void finished(const std::string& id, double seconds) const;
    void failed(const std::string& id, const std::string& reason) const;

private:
    std::filesystem::path path_;
};

/// The latest that a journal says of a case.
struct CaseHistory {
    enum class State { started, finished, failed } state = State::started;
    std::string reason;   // of the failure
    double seconds = 0.0; // of the last finished computation
    std::string host;
    double unix_time_s = 0.0;
};

struct JournalContents {
    std::map<std::string, CaseHistory> cases;
    bool running = false;               // a run has started and none has said since that it ended
    std::string last_run_ended;         // how
    std::vector<std::string> overrides; // of the last run, key=value
};

/// Empty when there is no journal. Throws UsageError (environment) when it cannot be read.
JournalContents read_journal(const std::filesystem::path& path);

std::string host_name();
/// UTC, ISO 8601, to the second.
std::string timestamp();

} // namespace shearwake
