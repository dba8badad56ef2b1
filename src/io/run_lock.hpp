#pragma once

#include <filesystem>
#include <optional>

namespace shearwake {

/// Held by rank 0 while a run computes into a folder: alone, or beside others that each compute
/// their own part of the sweep. The system releases it when the program ends, however it ends.
/// File systems without locks grant everything.
class RunLock {
public:
    enum class Sharing { alone, with_others };

    /// Locks `file`, which is made if it is not there. Throws UsageError when another run holds it,
    /// or (environment) when it cannot be opened. Not collective.
    RunLock(const std::filesystem::path& file, Sharing sharing);
    ~RunLock();
    RunLock(const RunLock&) = delete;
    RunLock& operator=(const RunLock&) = delete;

private:
    int fd_;
};

/// Whether a run holds the lock now; nothing where the file system cannot say.
std::optional<bool> is_locked(const std::filesystem::path& file);

} // namespace shearwake
