// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"
#include "schedule/run/deadline.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/run_arguments.hpp"

#include <memory>
#include <string>

namespace shearwake::adaptive {

/// What a shard of a sweep with adaptive axes knows of the other shards. While it exists, a lock in
/// the output folder shows that this shard takes part, also while it computes no case. Without
/// --shard it does nothing. On rank 0; not collective.
class OtherShards {
public:
    /// Throws UsageError if another process runs the same shard.
    OtherShards(schedule::OutputFolder folder, const schedule::RunArguments& arguments,
                const schedule::Deadline& deadline);

    /// How a wait has ended.
    struct Outcome {
        bool is_extended = false; // another shard has extended the plan
        /// Why the shard does not wait any longer: a request to stop, the time limit, or open cases
        /// of shards that are not running; otherwise empty.
        std::string reason;
    };

    /// Waits until all cases of the plan have ended, or another shard has extended the plan.
    Outcome wait(const Plan& plan) const;

    /// Whether the plan in the folder has more cases.
    bool is_extended(const Plan& plan) const;

private:
    std::vector<std::size_t> open_cases(const Plan& plan) const;
    bool is_any_running(const std::string& prefix) const;

    schedule::OutputFolder folder_;
    std::string part_; // empty: not in shards
    const schedule::Deadline& deadline_;
    std::unique_ptr<storage::RunLock> presence_;
};

} // namespace shearwake::adaptive
