#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace shearwake {

/// How far a sweep is.
struct SweepCounts {
    long total = 0; // to be done in this run
    long done = 0;
    long failed = 0;
    long running = 0;
};

/// Tells rank 0's user how far the sweep is: on a terminal one live line, elsewhere a plain line at
/// every 5 % or minute. Not collective.
class Progress {
public:
    enum class Style { automatic, quiet };
    /// `log`: a file that gets a JSON object a line besides; empty: none.
    Progress(Style style, std::filesystem::path log);

    /// Cheap: at most a few times a second it has something to say.
    void update(const SweepCounts& counts);
    /// A line of its own, between the others.
    void say(const std::string& line);
    void finish();

private:
    void log(const SweepCounts& counts);
    std::string line(const SweepCounts& counts) const;

    bool quiet_, live_;
    std::filesystem::path log_;
    std::chrono::steady_clock::time_point logged_;
    bool drawn_ = false;
    std::chrono::steady_clock::time_point began_, last_;
    long last_percent_ = 0;
};

} // namespace shearwake
