// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "schedule/output_folder.hpp"

#include <string>
#include <vector>

namespace shearwake::schedule {

/// The state of a sweep that is computed in shards.
struct ShardStates {
    std::size_t of = 0;                // number of shards; 0: not computed in shards
    std::vector<std::size_t> running;  // numbers of the shards whose lock a run holds
    std::vector<std::size_t> to_start; // with open cases, and not running
};

/// The shards of an output folder according to its journals; `open` are the positions in the plan
/// of the cases that are left. Runs with different numbers of shards count as not in shards. Not
/// collective.
ShardStates shard_states(const OutputFolder& folder, const std::vector<std::size_t>& open);

/// `run` for the shards to be started: with `--shard K/N`, or a loop of a shell over several.
std::string shards_command_line(const std::string& run, const ShardStates& shards);

} // namespace shearwake::schedule
