// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/shared_counters.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace shearwake::schedule {

/// The teams of a run, and the number of the team of this rank.
struct TeamOf {
    int teams = 1, team = 0;
};

/// Microseconds since a fixed time.
using Clock_us = std::function<long()>;
Clock_us steady_clock_us();

/// The remaining time of a sweep: that of running cases follows from their progress, that of others
/// from their estimates times the ratio of measured to estimated times of the cases that have ended
/// in this run. Shared by all teams. Only the constructor is collective.
class RemainingTime {
public:
    /// `estimated_s`: the estimated time of each case on its team.
    RemainingTime(std::vector<double> estimated_s, const Comm& world, TeamOf team = {},
                  Clock_us clock = steady_clock_us());

    void begin(std::size_t index);
    /// The share of the running case that is complete, 0 to 1; less than before if it is repeated.
    void progressed(double share);
    /// The case has ended or will not be computed in this run.
    void end(std::size_t index);
    /// Adds the measured time of a complete case.
    void learn(std::size_t index, double seconds);

    /// Ratio of measured to estimated time; 1 without any measurement.
    double ratio() const;
    /// Wall time until all teams have ended, of which `busy` still have a case: at least the
    /// remaining time of the longest running case.
    double wall_left_s(int busy) const;

private:
    enum Counter { taken, estimated, left, sums };
    /// When the running case of a team will have ended; 0 without a case.
    static int end_us(int team) { return sums + team; }
    void expect_end(long at_us);
    long estimated_us(std::size_t index) const;
    long now_us() const { return clock_() - began_; }

    std::vector<double> estimated_s_;
    TeamOf team_;
    Clock_us clock_;
    long began_, expected_end_us_ = 0;
    std::vector<bool> has_begun_;
    struct Report {
        double share;
        long at_us;
    };
    std::optional<Report> first_; // of the running case, which may follow a resume
    mutable std::optional<SharedCounters> counters_;
};

} // namespace shearwake::schedule
