// SPDX-License-Identifier: BSD-3-Clause
#include "storage/journal/claims.hpp"

#include "base/error.hpp"
#include "storage/files.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <optional>
#include <sys/file.h>
#include <unistd.h>

namespace shearwake::storage {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto between_counts = 2s;
/// A run whose count rests for this time has ended: five counts, and the caching time of network
/// file systems.
constexpr auto longest_rest = 15s;
constexpr auto between_looks = 250ms;

fs::path file_of_run(const fs::path& locks, const std::string& run) {
    return locks / (run + ".run");
}

fs::path file_of_case(const fs::path& locks, const std::string& id) {
    return locks / (id + ".case");
}

[[noreturn]] void refuse(const fs::path& file) {
    throw UsageError(fmt::format("cannot open {}: {}", file.string(), std::strerror(errno)),
                     ExitCode::environment, persistence_of(errno));
}

/// The first bytes of a file; nothing if it does not exist.
std::optional<std::string> text_of(const fs::path& file) {
    const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return std::nullopt;
    char text[320];
    const ssize_t length = ::read(fd, text, sizeof text);
    ::close(fd);
    return std::string(text, length > 0 ? static_cast<std::size_t>(length) : 0);
}

bool is_locked(const fs::path& file) {
    const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    const bool is_refused = fd >= 0 && ::flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (fd >= 0) ::close(fd);
    return is_refused;
}

/// Whether this call has created the file.
bool has_created(const fs::path& file, const std::string& text) {
    const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno != EEXIST) refuse(file);
    if (fd < 0) return false;
    const bool is_written = ::write(fd, text.data(), text.size()) == std::ssize(text);
    if (::close(fd) == 0 && is_written) return true;
    const int error = errno;
    ::unlink(file.c_str());
    errno = error;
    refuse(file);
}

std::vector<std::string> runs_in(const fs::path& locks) {
    std::vector<std::string> runs;
    for (const fs::path name : names_in(locks))
        if (name.extension() == ".run" && !is_stray(name)) runs.push_back(name.stem().string());
    return runs;
}

} // namespace

ActiveRun::ActiveRun(const fs::path& locks)
    : file_(file_of_run(locks, process_name())),
      fd_(::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (fd_ < 0) refuse(file_);
    // Others hold it for an instant while they look.
    for (int attempt = 0; ::flock(fd_, LOCK_EX | LOCK_NB) != 0 && attempt < 20; ++attempt)
        std::this_thread::sleep_for(5ms);
    write_count(0);
    counts_ = std::thread([this] { count(); });
}

/// The file is closed, since network file systems then show the count to other hosts. A count that
/// cannot be written is skipped.
void ActiveRun::write_count(long count) const {
    const int fd = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (fd < 0) return;
    const std::string text = fmt::format("{}\n", count);
    [[maybe_unused]] const ssize_t written = ::pwrite(fd, text.data(), text.size(), 0);
    ::close(fd);
}

void ActiveRun::count() {
    std::unique_lock guard(mutex_);
    for (long count = 1; !ended_.wait_for(guard, between_counts, [this] { return ending_; });
         ++count)
        write_count(count);
}

ActiveRun::~ActiveRun() {
    {
        const std::lock_guard guard(mutex_);
        ending_ = true;
    }
    ended_.notify_all();
    counts_.join();
    ::unlink(file_.c_str());
    ::close(fd_);
}

RunWatch::State RunWatch::look(const std::string& run) {
    const fs::path file = file_of_run(locks_, run);
    if (is_locked(file)) return State::active;
    const std::optional<std::string> text = text_of(file);
    if (!text || has_ended(run)) return State::ended;
    const auto now = std::chrono::steady_clock::now();
    const auto [known, is_new] = counts_.try_emplace(run, Count{*text, now});
    Count& count = known->second;
    if (!is_new && count.text != *text) {
        count = {*text, now};
        return State::active;
    }
    return now - count.since > longest_rest ? State::ended : State::unknown;
}

std::vector<std::string> active_runs(const fs::path& locks) {
    RunWatch watch(locks);
    std::vector<std::string> active, unknown = runs_in(locks);
    while (!unknown.empty()) {
        std::erase_if(unknown, [&](const std::string& run) {
            const RunWatch::State state = watch.look(run);
            if (state == RunWatch::State::active) active.push_back(run);
            return state != RunWatch::State::unknown;
        });
        if (!unknown.empty()) std::this_thread::sleep_for(between_looks);
    }
    return active;
}

void remove_ended_runs(const fs::path& locks) {
    RunWatch watch(locks);
    std::error_code ignored;
    for (const std::string& run : runs_in(locks))
        if (watch.look(run) == RunWatch::State::ended) fs::remove(file_of_run(locks, run), ignored);
}

void require_no_run(const fs::path& locks) {
    if (const std::vector<std::string> runs = active_runs(locks); !runs.empty())
        throw UsageError(
            fmt::format("{} is being computed by another run ({}); wait for it or stop "
                        "it",
                        locks.parent_path().string(), fmt::join(runs, ", ")));
}

CaseClaims::Answer CaseClaims::claim(const std::string& id) {
    const fs::path file = file_of_case(locks_, id);
    bool is_created = false;
    with_patience([&] { is_created = has_created(file, run_); });
    if (is_created) return Answer::granted;
    std::optional<std::string> owner = text_of(file);
    // Its name follows at once, unless the run was killed before.
    for (int attempt = 0; owner == "" && attempt < 10; ++attempt, owner = text_of(file))
        std::this_thread::sleep_for(20ms);
    if (owner && owner != "" && owner != run_ && watch_.look(*owner) != RunWatch::State::ended)
        return Answer::refused;
    const FileLock lock(folder_lock(locks_));
    if (lock.is_refused() || text_of(file) != owner)
        return Answer::refused; // another run is faster
    std::error_code ignored;
    fs::remove(file, ignored);
    return has_created(file, run_) ? Answer::inherited : Answer::refused;
}

bool CaseClaims::holds(const std::string& id) const {
    return claimed_by(locks_, id) == run_;
}

void CaseClaims::release(const std::string& id) const {
    if (holds(id)) ::unlink(file_of_case(locks_, id).c_str());
}

std::string claimed_by(const fs::path& locks, const std::string& id) {
    return text_of(file_of_case(locks, id)).value_or("");
}

} // namespace shearwake::storage
