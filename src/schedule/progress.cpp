// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/progress.hpp"

#include "storage/files.hpp"
#include "storage/journal/journal.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>

namespace shearwake::schedule {
namespace {

/// Under mpirun, stderr is a pipe to mpirun, whose stderr may be the terminal of the user.
bool user_sees_a_terminal() {
    if (::isatty(STDERR_FILENO)) return true;
    if (!std::getenv("OMPI_COMM_WORLD_SIZE")) return false;
    std::error_code error;
    const auto target = std::filesystem::read_symlink(
        fmt::format("/proc/{}/fd/{}", ::getppid(), STDERR_FILENO), error);
    return !error &&
           (target.string().starts_with("/dev/pts/") || target.string().starts_with("/dev/tty"));
}

std::string duration(double seconds) {
    const auto s = static_cast<long>(seconds + 0.5);
    if (s < 100) return fmt::format("{} s", s);
    if (s < 6000) return fmt::format("{} min {:02} s", s / 60, s % 60);
    return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

} // namespace

Progress::Progress(Style style, std::filesystem::path log)
    : quiet_(style == Style::quiet), live_(!quiet_ && user_sees_a_terminal()), log_(std::move(log)),
      began_(std::chrono::steady_clock::now()), last_(began_) {}

void Progress::start() {
    began_ = last_ = std::chrono::steady_clock::now();
}

/// Appends a line to the log every ten seconds and at the end.
void Progress::log(const SweepCounts& counts) {
    const auto now = std::chrono::steady_clock::now();
    if (now - logged_ < std::chrono::seconds(10) && counts.done + counts.failed < counts.total)
        return;
    logged_ = now;
    const double elapsed = std::chrono::duration<double>(now - began_).count();
    storage::append_line(
        log_, fmt::format(R"({{"time": "{}", "elapsed_s": {:.3f}, "total": {}, "done": {}, )"
                          R"("failed": {}, "running": {}, "left_s": {:.3f}}})",
                          storage::timestamp(), elapsed, counts.total, counts.done, counts.failed,
                          counts.running, counts.left_s));
}

void Progress::update(const SweepCounts& counts) {
    if (!log_.empty()) log(counts);
    if (quiet_ || counts.total == 0) return;
    const auto now = std::chrono::steady_clock::now();
    const double since = std::chrono::duration<double>(now - last_).count();
    const long ended = counts.done + counts.failed;
    const long percent = counts.total > 0 ? 100 * ended / counts.total : 100;
    const bool due = live_ ? since > 0.25 || ended == counts.total
                           : since > 60.0 || percent / 5 > last_percent_ / 5;
    if (!due) return;
    last_ = now;
    last_percent_ = percent;
    if (live_) {
        fmt::print(stderr, "\r\x1b[K{}", line(counts));
        drawn_ = true;
    } else {
        fmt::print(stderr, "{}\n", line(counts));
    }
    std::fflush(stderr);
}

std::string Progress::line(const SweepCounts& counts) const {
    const double elapsed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    const long ended = counts.done + counts.failed;
    std::string text = fmt::format("{}/{} cases done, {} running, {} failed", counts.done,
                                   counts.total, counts.running, counts.failed);
    if (ended > 0) text += fmt::format(", {:.3g} cases/s", static_cast<double>(ended) / elapsed);
    if (ended < counts.total) text += fmt::format(", {} remaining", duration(counts.left_s));
    return text;
}

void Progress::say(const std::string& text) {
    if (drawn_) fmt::print(stderr, "\r\x1b[K");
    drawn_ = false;
    fmt::print(stderr, "{}\n", text);
    std::fflush(stderr);
}

void Progress::finish() {
    if (drawn_) fmt::print(stderr, "\n");
    drawn_ = false;
}

} // namespace shearwake::schedule
