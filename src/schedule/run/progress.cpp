// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/progress.hpp"

#include "base/json.hpp"
#include "base/text.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <sys/ioctl.h>
#include <unistd.h>

namespace shearwake::schedule {
namespace {

/// The interval at which files are updated.
constexpr auto between_records = std::chrono::seconds(10);
/// After this time the state is recorded for the first time.
constexpr auto shortest_recorded = std::chrono::seconds(2);

/// The terminal of the user; empty without one. Under mpirun, stderr is a pipe to mpirun, whose
/// stderr may be the terminal.
std::string user_terminal() {
    if (::isatty(STDERR_FILENO)) return "/dev/stderr";
    if (!std::getenv("OMPI_COMM_WORLD_SIZE")) return "";
    const std::string target = fmt::format("/proc/{}/fd/{}", ::getppid(), STDERR_FILENO);
    std::error_code error;
    const std::string name = std::filesystem::read_symlink(target, error).string();
    return name.starts_with("/dev/pts/") || name.starts_with("/dev/tty") ? target : "";
}

/// The columns of a terminal, which may change; 80 if it does not state them.
std::size_t columns_of(const std::string& terminal) {
    winsize size = {};
    const int file = ::open(terminal.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
    if (file >= 0) {
        if (::ioctl(file, TIOCGWINSZ, &size) != 0) size = {};
        ::close(file);
    }
    return size.ws_col > 0 ? size.ws_col : 80;
}

/// "[######              ]  30 % "
std::string bar(double share) {
    constexpr int width = 20;
    const int full = static_cast<int>(std::clamp(share, 0.0, 1.0) * width);
    return fmt::format("[{:#<{}}{:{}}] {:3.0f} % ", "", full, "", width - full, 100.0 * share);
}

} // namespace

Progress::Progress(Style style, Log log)
    : quiet_(style == Style::quiet), terminal_(quiet_ ? "" : user_terminal()),
      live_(!terminal_.empty()), log_(std::move(log)), began_(Clock::now()), last_(began_) {}

void Progress::start() {
    began_ = last_ = Clock::now();
    recorded_ = began_ + shortest_recorded - between_records; // short runs record no state
}

/// Updates the files every ten seconds; finish() appends the last line.
void Progress::log(const SweepCounts& counts) {
    counts_ = counts;
    const auto now = Clock::now();
    if (!log_.lines.empty()) {
        has_unlogged_ = true;
        if (now - logged_ >= between_records) write_log();
    }
    if (!log_.state.empty() && now - recorded_ >= between_records) {
        recorded_ = now;
        write_state();
    }
}

/// docs/reference/json-output.md describes the members.
std::string Progress::json() const {
    const double elapsed_s = seconds_since(began_);
    return Json({{"schema", json_schema_version},
                 {"command", "run"},
                 {"folder", log_.folder},
                 {"time", storage::timestamp()},
                 {"elapsed_s", elapsed_s},
                 {"total", counts_.total},
                 {"done", counts_.done},
                 {"failed", counts_.failed},
                 {"running", counts_.running},
                 {"partial", counts_.partial},
                 {"left_s", counts_.left_s ? Json(*counts_.left_s) : Json()}})
        .text();
}

void Progress::write_log() {
    logged_ = Clock::now();
    has_unlogged_ = false;
    storage::append_line(log_.lines, json());
}

/// Under a temporary name, then renamed. An error is ignored, since only `status` reads the file.
void Progress::write_state() const {
    const std::filesystem::path part = storage::part_path(log_.state);
    std::ofstream file(part);
    file << json() << '\n';
    file.close();
    std::error_code ignored;
    if (file)
        std::filesystem::rename(part, log_.state, ignored);
    else
        std::filesystem::remove(part, ignored);
}

void Progress::update(const SweepCounts& counts) {
    if (!log_.lines.empty() || !log_.state.empty()) log(counts);
    if (quiet_ || counts.total == 0) return;
    const auto now = Clock::now();
    const double since = seconds_between(last_, now);
    const long ended = counts.done + counts.failed;
    const bool due = live_ ? since > 0.25 || ended == counts.total
                           : since > 60.0 || (ended == counts.total && !ended_);
    if (!due) return;
    last_ = now;
    ended_ = ended == counts.total;
    if (live_) {
        // A longer line would continue below, where "\r" does not return to its beginning.
        fmt::print(stderr, "\r\x1b[K{}", line(counts).substr(0, columns_of(terminal_) - 1));
        drawn_ = true;
    } else {
        fmt::print(stderr, "{}\n", line(counts));
    }
    std::fflush(stderr);
}

std::string Progress::line(const SweepCounts& counts) const {
    const double elapsed = seconds_since(began_);
    const long ended = counts.done + counts.failed;
    // A team may end a case before it resets its share.
    const double complete = std::min(1.0, (static_cast<double>(ended) + counts.partial) /
                                              static_cast<double>(counts.total));
    std::string text = live_ ? bar(complete) : "";
    text += fmt::format("{}/{} cases done, {} running", counts.done, counts.total, counts.running);
    if (!live_ && counts.running > 0 && counts.partial > 0.0) // the bar shows it
        text += fmt::format(" ({:.0f} % complete)",
                            100.0 * counts.partial / static_cast<double>(counts.running));
    text += fmt::format(", {} failed", counts.failed);
    if (!live_ && ended > 0)
        text += fmt::format(", {:.3g} cases/s", static_cast<double>(ended) / elapsed);
    if (ended < counts.total && counts.left_s)
        text += fmt::format(", {} remaining", duration_text(*counts.left_s));
    return text;
}

void Progress::report(const std::string& text) {
    drawn_ = false;
    // Rank 0 may have drawn the bar; it must not draw it between two writes.
    fmt::print(stderr, "{}{}\n", live_ ? "\r\x1b[K" : "", coloured(text, stderr));
    std::fflush(stderr);
}

void Progress::finish() {
    if (!log_.lines.empty() && has_unlogged_) write_log();
    std::error_code ignored;
    if (!log_.state.empty()) std::filesystem::remove(log_.state, ignored);
    if (drawn_) fmt::print(stderr, "\n");
    drawn_ = false;
}

std::optional<RecordedProgress> recorded_progress(const OutputFolder& folder,
                                                  const std::vector<std::string>& runs) {
    std::optional<RecordedProgress> sum;
    for (const std::string& name : runs) {
        std::error_code error; // the run may end at any time
        const auto written = std::filesystem::last_write_time(folder.progress(name), error);
        if (error) continue;
        const std::chrono::duration<double> age =
            std::filesystem::file_time_type::clock::now() - written;
        try {
            const Json run = Json::parse(storage::read_file(folder.progress(name)));
            RecordedProgress more = sum.value_or(RecordedProgress{});
            more.partial += run.at("partial").get<double>();
            // Each run estimates the time in which it would compute all of its cases.
            const double left = run.at("total").get<double>() - run.at("done").get<double>() -
                                run.at("failed").get<double>();
            const double left_s = run.at("left_s").is_number() ? run.at("left_s").get<double>() : 0;
            if (left_s > 0.0) more.cases_per_second += left / std::max(1.0, left_s - age.count());
            sum = more;
        } catch (const std::exception&) { // the file was removed
        }
    }
    return sum;
}

} // namespace shearwake::schedule
