// SPDX-License-Identifier: BSD-3-Clause
#include "storage/journal/run_lock.hpp"

#include "base/error.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sstream>
#include <sys/file.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace shearwake::storage {
namespace {

using namespace std::chrono_literals;

constexpr auto between_beats = 2s;
constexpr std::size_t beat_length = 320;

int open_or_throw(const std::filesystem::path& file) {
    const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (fd < 0)
        throw UsageError(fmt::format("cannot open {}: {}", file.string(), std::strerror(errno)),
                         ExitCode::environment, persistence_of(errno));
    return fd;
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& by) {
    throw UsageError(fmt::format("{} is being computed by another run{}; wait for it, stop it, or "
                                 "compute separate parts at the same time with --shard I/N",
                                 file.parent_path().parent_path().string(), by));
}

/// The data that the holder writes.
struct Beat {
    std::string host;
    long process = 0, count = 0;
    bool operator==(const Beat&) const = default;
};

Beat read_beat(int fd) {
    char text[beat_length + 1] = {};
    Beat beat;
    if (::pread(fd, text, beat_length, 0) > 0)
        std::istringstream(text) >> beat.host >> beat.process >> beat.count;
    return beat;
}

/// Whether the process that wrote it has ended, as far as this host can determine.
bool has_ended(const Beat& beat) {
    return beat.host == host_name() && ::kill(static_cast<pid_t>(beat.process), 0) != 0 &&
           errno == ESRCH;
}

Beat read_beat(const std::filesystem::path& file) {
    const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return {};
    const Beat beat = read_beat(fd);
    ::close(fd);
    return beat;
}

int lock_byte(int fd, short kind, std::size_t number) {
    struct flock range {};
    range.l_type = kind;
    range.l_whence = SEEK_SET;
    range.l_start = static_cast<off_t>(number);
    range.l_len = 1;
    // A lock of the open file description, which is released only when this is closed.
    return ::fcntl(fd, F_OFD_SETLK, &range);
}

} // namespace

RunLock::RunLock(const std::filesystem::path& file, Sharing sharing,
                 std::chrono::milliseconds watching)
    : file_(file), fd_(open_or_throw(file)) {
    try {
        lock_or_throw(sharing);
        refuse_if_locked_elsewhere(watching);
    } catch (...) {
        ::close(fd_);
        throw;
    }
    if (sharing == Sharing::with_others) return;
    write_beat(0);
    beats_ = std::thread([this] { beat(); });
}

void RunLock::lock_or_throw(Sharing sharing) {
    const int kind = (sharing == Sharing::alone ? LOCK_EX : LOCK_SH) | LOCK_NB;
    // `status` holds the lock briefly while it checks.
    for (int attempt = 0; ::flock(fd_, kind) != 0; ++attempt) {
        if (errno != EWOULDBLOCK && errno != EINTR) return; // the file system has no locks
        if (attempt == 20) {
            const Beat holder = read_beat(fd_);
            refuse(file_, holder.host.empty()
                              ? ""
                              : fmt::format(" (process {} on {})", holder.process, holder.host));
        }
        std::this_thread::sleep_for(25ms);
    }
    system_locks_ = true;
}

void RunLock::refuse_if_locked_elsewhere(std::chrono::milliseconds watching) const {
    const Beat before = read_beat(fd_);
    if (before.host.empty()) return;
    // On this host, the lock of the operating system is reliable, and an ended process holds none.
    if (before.host == host_name() && system_locks_) return;
    if (has_ended(before)) return;
    const auto end = std::chrono::steady_clock::now() + watching;
    while (std::chrono::steady_clock::now() < end) {
        std::this_thread::sleep_for(
            std::min<std::chrono::milliseconds>(between_beats / 4, watching / 4));
        if (read_beat(fd_) != before)
            refuse(file_, fmt::format(" (process {} on {})", before.process, before.host));
    }
}

void RunLock::write_beat(long count) const {
    std::string text = fmt::format("{} {} {}", host_name(), ::getpid(), count);
    text.resize(beat_length, ' ');
    // A beat that cannot be written is skipped.
    [[maybe_unused]] const ssize_t written = ::pwrite(fd_, text.data(), text.size(), 0);
}

void RunLock::beat() {
    std::unique_lock guard(mutex_);
    for (long count = 1; !ended_.wait_for(guard, between_beats, [this] { return ending_; });
         ++count)
        write_beat(count);
}

RunLock::~RunLock() {
    if (beats_.joinable()) {
        {
            const std::lock_guard guard(mutex_);
            ending_ = true;
        }
        ended_.notify_all();
        beats_.join();
        [[maybe_unused]] const int emptied = ::ftruncate(fd_, 0);
    }
    ::close(fd_);
}

std::optional<LockHolder> holder_in(const std::filesystem::path& locks,
                                    std::chrono::milliseconds watching) {
    std::vector<std::pair<std::filesystem::path, Beat>> watched;
    std::error_code missing;
    for (const auto& entry : std::filesystem::directory_iterator(locks, missing)) {
        const Beat beat = read_beat(entry.path());
        const bool mine = beat.host == host_name() && beat.process == ::getpid();
        if (!beat.host.empty() && !mine && !has_ended(beat))
            watched.emplace_back(entry.path(), beat);
    }
    if (watched.empty()) return std::nullopt;
    const auto end = std::chrono::steady_clock::now() + watching;
    while (std::chrono::steady_clock::now() < end) {
        std::this_thread::sleep_for(
            std::min<std::chrono::milliseconds>(between_beats / 4, watching / 4));
        for (const auto& [file, before] : watched) {
            const Beat now = read_beat(file); // empty after release
            if (!now.host.empty() && now != before) return LockHolder{now.host, now.process};
        }
    }
    return std::nullopt;
}

void refuse_beside_parts(const std::filesystem::path& locks, std::chrono::milliseconds watching) {
    if (const auto holder = holder_in(locks, watching))
        refuse(locks / "run", fmt::format(" (process {} on {})", holder->process, holder->host));
}

std::optional<bool> is_locked(const std::filesystem::path& file) {
    const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return std::nullopt;
    const int refused = ::flock(fd, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
    ::close(fd);
    if (refused == 0) return false;
    if (refused == EWOULDBLOCK) return true;
    return std::nullopt;
}

CaseClaims::CaseClaims(const std::filesystem::path& file) : fd_(open_or_throw(file)) {}

CaseClaims::~CaseClaims() {
    ::close(fd_);
}

bool CaseClaims::claim(std::size_t number) const {
    return lock_byte(fd_, F_WRLCK, number) == 0 || (errno != EAGAIN && errno != EACCES);
}

void CaseClaims::release(std::size_t number) const {
    lock_byte(fd_, F_UNLCK, number);
}

} // namespace shearwake::storage
