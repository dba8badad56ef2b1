// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace shearwake::storage {

/// The lock that rank 0 holds while a run computes into a folder: exclusive, or shared by runs that
/// each compute a part of the sweep. The operating system releases it when the program ends for any
/// reason.
///
/// Some network file systems have no locks, or grant the same lock to every host. Therefore, an
/// exclusive holder also writes its host, its process and a count to the file, and increases the
/// count every few seconds. A lock whose count increases is in use, independent of the lock of the
/// file system; if it does not increase, the run has crashed. After a crash, the next run observes
/// the count for some seconds.
class RunLock {
public:
    enum class Sharing { alone, with_others };

    /// Locks `file`, which is created if necessary. Throws UsageError when another run holds it, or
    /// (environment) when it cannot be opened. Not collective. `watching`: how long the count of
    /// another host is observed; the default is three beats plus the caching time of network file
    /// systems.
    RunLock(const std::filesystem::path& file, Sharing sharing,
            std::chrono::milliseconds watching = std::chrono::seconds(10));
    ~RunLock();
    RunLock(const RunLock&) = delete;
    RunLock& operator=(const RunLock&) = delete;

private:
    void lock_or_throw(Sharing sharing);
    void refuse_if_locked_elsewhere(std::chrono::milliseconds watching) const;
    void write_beat(long count) const;
    void beat();

    std::filesystem::path file_;
    int fd_;
    bool system_locks_ = false; // the operating system has granted it
    std::mutex mutex_;
    std::condition_variable ended_;
    bool ending_ = false;
    std::thread beats_;
};

/// A holder whose count increases.
struct LockHolder {
    std::string host;
    long process = 0;
};

/// Another process that holds a lock file of the folder `locks` according to its count, independent
/// of the locks of the operating system. Observes for the time `watching`, and only if there is a
/// count that may be active. Not collective.
std::optional<LockHolder> holder_in(const std::filesystem::path& locks,
                                    std::chrono::milliseconds watching = std::chrono::seconds(5));

/// For a run of the complete sweep that already holds a lock of the folder `locks`: throws
/// UsageError if a run of a part holds another lock there. Not collective.
void refuse_beside_parts(const std::filesystem::path& locks,
                         std::chrono::milliseconds watching = std::chrono::seconds(10));

/// Whether a run holds the lock; nothing if the file system cannot determine it.
std::optional<bool> is_locked(const std::filesystem::path& file);

/// Claims of cases, so that no case is computed twice at the same time, independent of the options
/// of the runs: byte n of a file is locked while case n is being computed. File systems without
/// locks grant all claims.
class CaseClaims {
public:
    /// Throws UsageError (environment) when the file cannot be opened. Not collective.
    explicit CaseClaims(const std::filesystem::path& file);
    ~CaseClaims();
    CaseClaims(const CaseClaims&) = delete;
    CaseClaims& operator=(const CaseClaims&) = delete;

    /// False if another process holds the claim.
    bool claim(std::size_t number) const;
    void release(std::size_t number) const;

private:
    int fd_;
};

} // namespace shearwake::storage
