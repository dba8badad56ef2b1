#pragma once

#include "parallel/comm.hpp"

#include <chrono>
#include <limits>
#include <string>

namespace shearwake {

/// Seconds of "90", "1:30", "2:00:00" or "1-12:00:00". Throws UsageError for anything else.
double parse_walltime(const std::string& text);

/// When a run must have ended: by its --walltime, by the limit of the Slurm job that it is in, or
/// never. It keeps a twentieth of its time, at most a minute, for saving what is at work then.
class Deadline {
public:
    Deadline() = default;
    /// `walltime` may be empty. Rank 0 asks Slurm (SLURM_JOB_END_TIME, else squeue); a clock that
    /// is set anew afterwards changes nothing. Collective.
    Deadline(const std::string& walltime, const Comm& world);

    bool exists() const { return limit_s_ < std::numeric_limits<double>::infinity(); }
    /// Of the whole run.
    double limit_s() const { return limit_s_; }
    double left_s() const;
    /// Whether something that needs so long may begin now: when it ends in time, and when it is
    /// longer than the whole time and has most of it, for what can be saved goes on in the next run
    /// and nothing else would ever be tried.
    bool lets_begin(double needed_s) const { return lets_begin(needed_s, left_s()); }
    bool lets_begin(double needed_s, double left_s) const;

private:
    double limit_s_ = std::numeric_limits<double>::infinity();
    std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

} // namespace shearwake
