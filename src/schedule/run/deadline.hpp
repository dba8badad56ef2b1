// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "parallel/comm.hpp"

#include <limits>
#include <string>

namespace shearwake::schedule {

/// Installs handlers by which SIGINT, SIGTERM, SIGHUP and the warnings of batch systems (SIGUSR1,
/// SIGUSR2, SIGXCPU) request an orderly stop: running cases write a checkpoint, or are abandoned
/// after 10 s if their engine has none, and no further cases are started. A rank that others block
/// ends some seconds later. A second signal ends the program immediately, except for a SIGXCPU, and
/// a SIGUSR1 or SIGUSR2 within two seconds of the first. SIGHUP remains ignored below nohup.
void watch_for_stop_signals(const Comm& world);

/// Whether this rank has received such a signal.
bool stop_requested();

/// Seconds of "90", "1:30", "2:00:00", "1-12", "1-12:00" or "1-12:00:00". Throws UsageError for
/// anything else.
double parse_walltime(const std::string& text);

/// The time at which a run must have ended, given by --walltime, by the limit of its Slurm job, or
/// neither. A twentieth of the time, at most a minute, is reserved for checkpoints of running
/// cases.
class Deadline {
public:
    Deadline() = default;
    /// `walltime` may be empty. Rank 0 queries Slurm (SLURM_JOB_END_TIME, otherwise squeue). Later
    /// changes of the system clock have no effect. Collective.
    Deadline(const std::string& walltime, const Comm& world);

    bool exists() const { return limit_s_ < std::numeric_limits<double>::infinity(); }
    /// Time limit of the complete run.
    double limit_s() const { return limit_s_; }
    double left_s() const;
    /// Whether a case that takes `needed_s` may start now: if it will end in time, or if it takes
    /// longer than the limit and most of the time remains. Such a case is resumed from its
    /// checkpoint in the next run; otherwise it would never start.
    bool lets_begin(double needed_s) const { return lets_begin(needed_s, left_s()); }
    bool lets_begin(double needed_s, double left_s) const;

private:
    double limit_s_ = std::numeric_limits<double>::infinity();
    Clock::time_point began_ = Clock::now();
};

} // namespace shearwake::schedule
