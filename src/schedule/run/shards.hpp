// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "schedule/run/output_folder.hpp"

#include <string>
#include <vector>

namespace shearwake::schedule {

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
