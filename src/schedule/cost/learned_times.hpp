// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/shared_counters.hpp"
#include "storage/journal/journal.hpp"

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::schedule {

/// The properties of a case that determine its time.
struct ExpectedCase {
    std::string engine;
    std::string kinds;        // of work; estimates of cases with the same kinds have similar errors
    double estimated_s = 0.0; // on its team
};

/// The teams of a run, and the number of the team of this rank.
struct TeamOf {
    int teams = 1, team = 0;
};

/// Microseconds since a fixed time.
using Clock_us = std::function<long()>;
Clock_us steady_clock_us();

/// Corrects the estimates of a sweep by the ratio of measured to estimated times: that of cases
/// with the same kinds of work or, without any, that of cases with the same engine. The ratios
/// include earlier runs that the journal records, and are shared by all teams. Only the constructor
/// is collective.
class LearnedTimes {
public:
    LearnedTimes(std::vector<ExpectedCase> cases, const Comm& world, TeamOf team = {},
                 Clock_us clock = steady_clock_us());

    /// Adds the times of earlier runs. On one rank only.
    void load(const storage::JournalContents& journal);
    void begin(std::size_t index);
    /// The share of a running case that is complete, 0 to 1. From then on, its remaining time
    /// follows from the time that the second half of these steps took, since the first steps may be
    /// slower, and corrects the estimates of similar cases.
    void progressed(std::size_t index, double share);
    /// The case has ended or will not be computed in this run.
    void end(std::size_t index);
    /// Adds the measured time of a case and the estimate of the same work.
    void learn(std::size_t index, double seconds, double estimated_s);

    /// Ratio of measured to estimated time; 1 without any measurement.
    double factor(std::size_t index) const;
    /// Remaining time of all teams together, without the part of running cases that has elapsed.
    double left_s() const;
    /// Wall time until all teams have ended, of which `busy` still have a case: at least the
    /// remaining time of the longest running case.
    double wall_left_s(int busy) const;

private:
    struct Group {
        int taken, estimated; // counters of microseconds
    };
    Group group(int number) const { return {2 * number, 2 * number + 1}; }
    void add(int number, double seconds, double estimated_s);
    /// The ratio of a group; 0 without any measurement.
    double ratio(int number) const;
    double ratio_of_case(int group, int engine) const;
    int left_counter(int number) const { return 2 * group_count_ + number; }
    int at_work() const { return 3 * group_count_; }
    int begun_us() const { return at_work() + 1; }
    int extrapolated_us() const { return at_work() + 2; }
    /// When the running case of a team will have ended; 0 without a case.
    int end_us(int team) const { return at_work() + 3 + team; }
    void expect_end(long at_us);
    /// Removes a case from the sums of estimates.
    void leave_estimates(std::size_t index);
    /// Replaces the contribution of a case's progress to the counters.
    void replace(std::size_t index, long taken_us, long estimated_us, long left_us);
    long now_us() const { return clock_() - began_; }

    std::vector<ExpectedCase> cases_;
    TeamOf team_;
    Clock_us clock_;
    long began_, expected_end_us_ = 0;
    std::map<std::string, int> numbers_; // of engines and kinds
    std::vector<int> engines_, groups_;  // of each case
    std::vector<long> began_us_;         // of each case that this team computes
    struct Report {
        double share = 0.0;
        long at_us = 0;
    };
    /// What the progress of a running case contributes to the counters.
    struct Partial {
        bool counts = false;
        Report first;              // which may follow a resume
        std::deque<Report> recent; // since about half of the progress
        long taken_us = 0, estimated_us = 0, left_us = 0;
    };
    std::map<std::size_t, Partial> partial_; // of the cases that this team computes
    std::vector<int> engine_of_group_;
    int group_count_ = 0;
    mutable std::optional<SharedCounters> counters_;
};

} // namespace shearwake::schedule
