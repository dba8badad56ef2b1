#include "io/run_lock.hpp"

#include "base/error.hpp"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <thread>
#include <unistd.h>

namespace shearwake {

RunLock::RunLock(const std::filesystem::path& file, Sharing sharing)
    : fd_(::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
    if (fd_ < 0)
        throw UsageError(fmt::format("cannot open {}: {}", file.string(), std::strerror(errno)),
                         ExitCode::environment);
    const int kind = (sharing == Sharing::alone ? LOCK_EX : LOCK_SH) | LOCK_NB;
    // `status` holds it for a moment when it looks.
    for (int attempt = 0; ::flock(fd_, kind) != 0; ++attempt) {
        if (errno != EWOULDBLOCK && errno != EINTR) return; // no locks here
        if (attempt == 20) {
            ::close(fd_);
            throw UsageError(fmt::format(
                "{} is being computed by another run: wait for it or stop it; --shard I/N lets "
                "several runs share the work",
                file.parent_path().string()));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(25));
    }
}

RunLock::~RunLock() {
    ::close(fd_);
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

} // namespace shearwake
