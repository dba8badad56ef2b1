// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "schedule/run/case_queue.hpp"

#include <array>
#include <string>
#include <variant>
#include <vector>

namespace shearwake::schedule {

/// The outcome of a run, see the counters of RunState. Identical on all ranks.
struct WorkResult {
    long done = 0;
    long failed = 0;
    long failed_files = 0;
    long postponed = 0;
    long elsewhere = 0;
    bool asked_to_stop = false; // by a signal, the STOP file or the time limit
    bool given_up = false;      // after file errors, or after any failure with --fail-fast
    bool folder_removed = false;
    std::vector<std::size_t> computed; // positions in the plan; on rank 0 only
};

/// Computes the cases of a queue on one team.
class Worker {
public:
    /// Collective over the world.
    Worker(const WorkList& list, const Comm& world, const Comm& team, Progress& progress);

    void work();
    /// Rank 0 prints the progress until the other teams have finished. Collective over the world.
    WorkResult wait_for_others();

private:
    void wait();
    RunState::CaseEnd compute_with_retries(const PlannedCase& planned);
    bool compute(const PlannedCase& planned);
    void add_rate(const PlannedCase& planned, const pipeline::CaseOutcome& outcome);
    void free_engines();
    /// Records the rates of the complete cases of all teams. Collective over the world.
    void record_rates() const;

    WorkList list_;
    const Comm& world_;
    const Comm& team_;
    RunState state_;
    CaseReporter reporter_;
    CaseQueue queue_;
    /// The time and the work of complete cases of each engine, by the index of its options.
    struct Measured {
        double core_s = 0.0, work = 0.0;
    };
    std::array<Measured, std::variant_size_v<SolverOptions>> measured_{}; // on the root of the team
    bool has_waited_ = false;                                             // for other runs
    std::size_t at_ = 0;           // position of the running case in the list
    const Case* before_ = nullptr; // previous case of the team
    std::string shared_;           // by the data that the team has, see engines::Resources
    std::vector<double> computed_; // positions in the plan; on the root of the team
};

} // namespace shearwake::schedule
