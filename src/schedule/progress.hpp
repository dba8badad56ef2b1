// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace shearwake::schedule {

/// The progress of a sweep.
struct SweepCounts {
    long total = 0; // cases to be computed in this run
    long done = 0;
    long failed = 0;
    long running = 0;
    double partial = 0.0; // sum of the complete shares of the running cases
    double left_s = 0.0;  // estimated time until the teams have ended
};

/// Prints the progress on rank 0: a bar that is redrawn on a terminal, elsewhere a line per minute
/// and at the end. Not collective.
class Progress {
public:
    enum class Style { automatic, quiet };
    /// A file to which a JSON object per line is appended; an empty path: none.
    struct Log {
        std::filesystem::path path;
        std::string folder, part; // of the run; an empty part: the complete sweep
    };
    Progress(Style style, Log log);

    /// Starts the clock from which the rate is computed.
    void start();
    /// Prints the progress if a line is due. Cheap, may be called often.
    void update(const SweepCounts& counts);
    /// Prints a separate line.
    void say(const std::string& line);
    void finish();

private:
    void log(const SweepCounts& counts);
    void write_log();
    std::string line(const SweepCounts& counts) const;

    bool quiet_, live_;
    Log log_;
    std::chrono::steady_clock::time_point logged_;
    SweepCounts counts_;                 // the latest ones
    bool has_unlogged_ = false;          // whether they are not in the log
    bool drawn_ = false, ended_ = false; // ended_: the last line is printed
    std::chrono::steady_clock::time_point began_, last_;
};

} // namespace shearwake::schedule
