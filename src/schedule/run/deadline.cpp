// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/deadline.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <optional>
#include <string_view>
#include <unistd.h>
#include <vector>

namespace shearwake::schedule {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Seconds of a time in the format [[hours:]minutes:]seconds or days-hours[:minutes[:seconds]],
/// which Slurm uses as well.
std::optional<double> seconds_in(const std::string& text) {
    std::size_t at = 0;
    const auto number = [&]() -> std::optional<double> {
        const std::size_t begin = at;
        while (at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0)
            ++at;
        if (at == begin || at - begin > 9) return std::nullopt;
        return std::stod(text.substr(begin, at - begin));
    };
    std::optional<double> days;
    std::vector<double> parts;
    do {
        const auto part = number();
        if (!part) return std::nullopt;
        if (at < text.size() && text[at] == '-' && parts.empty() && !days)
            days = *part;
        else
            parts.push_back(*part);
    } while (at < text.size() && (text[at] == ':' || text[at] == '-') && ++at > 0);
    if (at != text.size() || parts.empty() || parts.size() > 3) return std::nullopt;
    if (days) parts.resize(3, 0.0); // minutes and seconds
    double seconds = 0.0;
    for (const double part : parts)
        seconds = 60.0 * seconds + part;
    return 86400.0 * days.value_or(0.0) + seconds;
}

/// The first line of the output of a command; empty if it cannot be run.
std::string first_line_of(const std::string& command) {
    struct Close {
        void operator()(std::FILE* pipe) const { ::pclose(pipe); }
    };
    const std::unique_ptr<std::FILE, Close> pipe(::popen(command.c_str(), "r"));
    std::array<char, 256> line{};
    if (!pipe || !std::fgets(line.data(), line.size(), pipe.get())) return "";
    const std::string text = line.data();
    return text.substr(0, text.find_last_not_of(" \n") + 1);
}

double remaining_in_slurm_s() {
    if (const char* end = std::getenv("SLURM_JOB_END_TIME")) {
        const double now =
            std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
                .count();
        const double left = std::strtod(end, nullptr) - now;
        // An end that is in the past or years away is not plausible.
        return left > -60.0 && left < 3.2e8 ? std::max(left, 0.0) : never;
    }
    const char* job = std::getenv("SLURM_JOB_ID");
    if (!job || std::string(job).find_first_not_of("0123456789") != std::string::npos) return never;
    return seconds_in(first_line_of(std::string("squeue -h -o %L -j ") + job + " 2>/dev/null"))
        .value_or(never); // UNLIMITED, or no squeue
}

} // namespace

double parse_walltime(const std::string& text) {
    const auto seconds = seconds_in(text);
    if (!seconds || *seconds <= 0.0)
        throw UsageError("--walltime " + text +
                         ": must be seconds or days-hours:minutes:seconds, for example 5400, "
                         "1:30:00 or 2-00:00");
    return *seconds;
}

Deadline::Deadline(const std::string& walltime, const Comm& world) {
    const double given_s = walltime.empty() ? never : parse_walltime(walltime);
    const double slurm_s = world.is_root() ? remaining_in_slurm_s() : 0.0;
    limit_s_ = std::min(given_s, world.max(slurm_s));
}

bool Deadline::lets_begin(double needed_s, double left_s) const {
    if (needed_s <= left_s) return true;
    return needed_s > 0.9 * limit_s_ && left_s > 0.8 * limit_s_;
}

double Deadline::left_s() const {
    const double reserve_s = std::min(60.0, 0.05 * limit_s_);
    return limit_s_ - reserve_s - seconds_since(began_);
}

namespace {

// Global, since a signal handler can access nothing else.
volatile std::sig_atomic_t stop_signalled = 0;

volatile std::sig_atomic_t last_signal_s = 0;

volatile std::sig_atomic_t may_be_blocked = 0;
constexpr double blocked_s = 15.0; // half of the time that Slurm leaves after a signal

/// Seconds of a monotonic clock, which a signal handler may read.
std::sig_atomic_t now_s() {
    struct timespec now {};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::sig_atomic_t>(now.tv_sec);
}

void on_signal(int signal) {
    // The batch system, its script and mpirun may all forward the same signal, and the kernel sends
    // SIGXCPU every second.
    const bool repeated = signal == SIGXCPU || ((signal == SIGUSR1 || signal == SIGUSR2) &&
                                                now_s() - last_signal_s <= 2);
    if (stop_signalled != 0 && !repeated) {
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
    stop_signalled = 1;
    last_signal_s = now_s();
    if (may_be_blocked != 0) ::alarm(1);
}

/// Ends a rank that waits for others, which will not come: after a stop signal, it has made no
/// progress for much longer than ever before. Saved results and checkpoints are complete.
void on_alarm(int) {
    if (Comm::overdue_s() > blocked_s) {
        constexpr std::string_view text =
            "shearwake: a rank has been blocked since the stop signal and is ended; rerun the "
            "command to resume\n";
        [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
        ::_exit(static_cast<int>(ExitCode::stopped_early));
    }
    ::alarm(1);
}

} // namespace

void watch_for_stop_signals(const Comm& world) {
    Comm::mark_progress();
    may_be_blocked = world.size() > 1 ? 1 : 0;
    if (may_be_blocked != 0) std::signal(SIGALRM, on_alarm);
    for (const int signal : {SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGHUP})
        if (std::signal(signal, on_signal) == SIG_IGN && signal == SIGHUP)
            std::signal(SIGHUP, SIG_IGN); // nohup
}

bool stop_requested() {
    Comm::mark_progress();
    return stop_signalled != 0;
}

} // namespace shearwake::schedule
