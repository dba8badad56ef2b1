// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace shearwake::storage {

/// Runs in one output folder share its cases. In the folder `locks`, each run has a file
/// `<run>.run`, named by process_name() of its rank 0, and each case that is being computed a file
/// `<id>.case`, which contains the name of the run. Since a file is created by one process only,
/// this requires no locks of the file system: they only reveal sooner that a run has ended.

/// The file that a FileLock locks while the plan or the owner of a case changes.
inline std::filesystem::path folder_lock(const std::filesystem::path& locks) {
    return locks / "folder";
}

/// The file of a run, on rank 0 from its start to its end: it is locked, and contains a count that
/// increases every two seconds.
class ActiveRun {
public:
    /// Throws UsageError (environment) when the file cannot be opened. Not collective.
    explicit ActiveRun(const std::filesystem::path& locks);
    ~ActiveRun();
    ActiveRun(const ActiveRun&) = delete;
    ActiveRun& operator=(const ActiveRun&) = delete;

private:
    void write_count(long count) const;
    void count();

    std::filesystem::path file_;
    int fd_;
    std::mutex mutex_;
    std::condition_variable ended_;
    bool ending_ = false;
    std::thread counts_;
};

/// Observes whether runs are active.
class RunWatch {
public:
    explicit RunWatch(std::filesystem::path locks) : locks_(std::move(locks)) {}

    /// `unknown`: neither a lock nor this host shows it, and its count has not been observed for
    /// long enough. Not collective.
    enum class State { active, ended, unknown };
    State look(const std::string& run);

private:
    struct Count {
        std::string text;
        std::chrono::steady_clock::time_point since;
    };
    std::filesystem::path locks_;
    std::map<std::string, Count> counts_; // by run
};

/// The names of the active runs. Observes for some seconds if the file of a run of another host
/// remains. Not collective.
std::vector<std::string> active_runs(const std::filesystem::path& locks);

/// Removes the files of runs that have ended. Not collective.
void remove_ended_runs(const std::filesystem::path& locks);

/// Throws UsageError if a run is active. Not collective.
void require_no_run(const std::filesystem::path& locks);

/// Claims of cases for one run. No member is collective.
class CaseClaims {
public:
    CaseClaims(std::filesystem::path locks, std::string run)
        : locks_(std::move(locks)), run_(std::move(run)), watch_(locks_) {}

    /// `refused`: by another run that has not ended; `inherited`: from a run that has ended before
    /// the case was released.
    enum class Answer { refused, granted, inherited };
    /// Throws UsageError (environment) when the file cannot be created.
    Answer claim(const std::string& id);
    /// Whether this run still holds the claim: one that did not count for long has lost it.
    bool holds(const std::string& id) const;
    void release(const std::string& id) const;

private:
    std::filesystem::path locks_;
    std::string run_;
    RunWatch watch_;
};

/// The run that has claimed a case, which may have ended; empty without one. Not collective.
std::string claimed_by(const std::filesystem::path& locks, const std::string& id);

} // namespace shearwake::storage
