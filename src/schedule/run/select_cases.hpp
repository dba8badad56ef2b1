// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "problem/case/plan.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/run.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/journal/journal.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace shearwake::schedule {

/// The cases that a run has to compute. Other ranks than 0 only have what share() broadcasts.
struct Selection {
    std::vector<std::size_t> work;   // positions in Plan::cases
    std::vector<std::size_t> there;  // positions of the complete cases
    std::vector<std::size_t> others; // positions of the cases that are not selected
    std::size_t total = 0;
    std::size_t complete = 0;     // cases with a complete file
    long failed_before = 0;       // that are not retried
    std::size_t not_selected = 0; // by --only or --shard
};

/// Cases that failed because of files or disks are retried; cases with errors of their own only
/// with
/// --retry-failed. Throws UsageError for an unknown id or an invalid shard. Not collective.
Selection select_cases(const Plan& plan, const storage::JournalContents& journal,
                       storage::CaseIndex& index, const RunArguments& arguments);

/// Name of the selected part of the sweep in the names of its journal and lock: empty for the
/// complete sweep, "2-of-8" for a shard, "only-<id>" with the first selected case. Throws
/// UsageError for an invalid shard. Not collective.
std::string part_name(const RunArguments& arguments);

/// Broadcasts the work and the failures of rank 0. Collective.
void share(Selection& selection, const Comm& world);

/// The state of a sweep that is computed in shards.
struct ShardStates {
    std::size_t of = 0;                // number of shards; 0: not computed in shards
    std::vector<std::size_t> running;  // numbers of the shards whose lock a run holds
    std::vector<std::size_t> to_start; // with open cases, and not running
};

/// The shards of an output folder according to its locks and journals; `open` are the positions in
/// the plan of the cases that are left, and `last_part` is that of the last run. The number of
/// shards is that of the runs at work; without any, that of the earlier runs, unless these differ
/// or the last run was one of the complete sweep. Not collective.
ShardStates shard_states(const OutputFolder& folder, const std::vector<std::size_t>& open,
                         const std::string& last_part);

/// `run` for the shards to be started: with `--shard K/N`, or a loop of a shell over several.
std::string shards_command_line(const std::string& run, const ShardStates& shards);

} // namespace shearwake::schedule
