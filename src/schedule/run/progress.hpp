// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "problem/case/plan.hpp"
#include "schedule/run/output_folder.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::schedule {

/// The progress of a sweep.
struct SweepCounts {
    long total = 0; // cases to be computed in this run, without those that others have computed
    long done = 0;
    long failed = 0;
    long running = 0;
    double partial = 0.0;         // sum of the complete shares of the running cases
    std::optional<double> left_s; // until the teams have ended, see time_left_s()
};

/// The remaining time, if `done` of `total` units of work have taken `elapsed_s`; nothing before
/// any is done. All commands estimate remaining times with this function.
constexpr std::optional<double> time_left_s(double elapsed_s, double done, double total) {
    if (done >= total) return 0.0;
    if (!(done > 0.0)) return std::nullopt;
    return elapsed_s * (total - done) / done;
}

/// What the active runs of an output folder have recorded.
struct RecordedProgress {
    double partial = 0.0;          // sum of the complete shares of the running cases
    double cases_per_second = 0.0; // of the runs together
};
/// The progress of these runs; nothing if none has recorded any. Not collective.
std::optional<RecordedProgress> recorded_progress(const OutputFolder& folder,
                                                  const std::vector<std::string>& runs);

/// Prints the progress on rank 0: a bar that is redrawn on a terminal, elsewhere a line per minute
/// and at the end. Not collective.
class Progress {
public:
    enum class Style { automatic, quiet };
    /// Where the progress is recorded as JSON; an empty path: nowhere.
    struct Log {
        std::filesystem::path lines; // a line is appended every ten seconds
        std::filesystem::path state; // contains the latest progress while the run is at work
        std::string folder;          // of the run
    };
    Progress(Style style, Log log);

    /// Starts the clock from which the rate is computed.
    void start();
    /// Prints the progress if a line is due. Cheap, may be called often.
    void update(const SweepCounts& counts);
    /// Prints a separate line.
    void report(const std::string& line);
    void finish();

private:
    void log(const SweepCounts& counts);
    void write_log();
    void write_state() const;
    std::string json() const;
    std::string line(const SweepCounts& counts) const;

    bool quiet_;
    std::string terminal_; // where the bar is drawn
    bool live_;
    Log log_;
    Clock::time_point logged_, recorded_; // lines and state
    SweepCounts counts_;                  // the latest ones
    bool has_unlogged_ = false;           // whether they are not in the log
    bool drawn_ = false, ended_ = false;  // ended_: the last line is printed
    Clock::time_point began_, last_;
};

} // namespace shearwake::schedule
