#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace shearwake {

/// Held by rank 0 while a run computes into a folder: alone, or beside others that each compute
/// their own part of the sweep. The system releases it when the program ends, however it ends.
///
/// Some network file systems have no locks, or grant every host the same one. Therefore the holder
/// that is alone also writes its host, its process and a count into the file that rises every few
/// seconds: what another host still counts up is in use, whatever the lock says; what it does not
/// has ended with a crash. A folder that was left so costs the next run some seconds of watching.
class RunLock {
public:
    enum class Sharing { alone, with_others };

    /// Locks `file`, which is made if it is not there. Throws UsageError when another run holds it,
    /// or (environment) when it cannot be opened. Not collective.
    /// `watching`: how long the count of another host is looked at; the default is three beats and
    /// what a network file system may keep from another host.
    RunLock(const std::filesystem::path& file, Sharing sharing,
            std::chrono::milliseconds watching = std::chrono::seconds(10));
    ~RunLock();
    RunLock(const RunLock&) = delete;
    RunLock& operator=(const RunLock&) = delete;

private:
    void lock_or_throw(Sharing sharing);
    void refuse_if_held_elsewhere(std::chrono::milliseconds watching) const;
    void write_beat(long count) const;
    void beat();

    std::filesystem::path file_;
    int fd_;
    bool system_locks_ = false; // the system has granted it
    std::mutex mutex_;
    std::condition_variable ended_;
    bool ending_ = false;
    std::thread beats_;
};

/// Somebody whose count rises.
struct LockHolder {
    std::string host;
    long process = 0;
};

/// Another process that holds a lock file of the folder `locks`, as its count tells, whatever the
/// system's locks say. Looks for as long as `watching`, and only if a count is there that may be at
/// work. Not collective.
std::optional<LockHolder> holder_in(const std::filesystem::path& locks,
                                    std::chrono::milliseconds watching = std::chrono::seconds(5));

/// For a run of everything, which holds a lock of the folder `locks` already: throws UsageError
/// when a run of a part holds another one there. Not collective.
void refuse_beside_parts(const std::filesystem::path& locks,
                         std::chrono::milliseconds watching = std::chrono::seconds(10));

/// Whether a run holds the lock now; nothing where the file system cannot say.
std::optional<bool> is_locked(const std::filesystem::path& file);

/// The cases that runs are at work on, so that no case is computed twice at the same time whatever
/// the runs were told to do: byte n of a file is locked while case n is at work. File systems
/// without locks grant everything.
class CaseClaims {
public:
    /// Throws UsageError (environment) when the file cannot be opened. Not collective.
    explicit CaseClaims(const std::filesystem::path& file);
    ~CaseClaims();
    CaseClaims(const CaseClaims&) = delete;
    CaseClaims& operator=(const CaseClaims&) = delete;

    /// False when another process has it.
    bool claim(std::size_t number) const;
    void release(std::size_t number) const;

private:
    int fd_;
};

} // namespace shearwake
