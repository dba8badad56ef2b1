// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/shards.hpp"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <set>

namespace shearwake::schedule {

namespace {

struct WrittenShard {
    std::size_t number = 0, of = 0;
};

/// The shards that have a file in a folder: `prefix`, "2-of-8", and any end.
std::vector<WrittenShard> shards_in(const std::filesystem::path& folder,
                                    const std::string& prefix) {
    std::vector<WrittenShard> found;
    std::error_code missing; // a missing folder has none
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
        WrittenShard shard;
        const std::string name = entry.path().filename().string();
        if (name.starts_with(prefix) &&
            std::sscanf(name.c_str() + prefix.size(), "%zu-of-%zu", &shard.number, &shard.of) ==
                2 &&
            shard.of > 0)
            found.push_back(shard);
    }
    return found;
}

bool is_running(const OutputFolder& folder, const WrittenShard& shard) {
    const auto lock = folder.part_lock(fmt::format("{}-of-{}", shard.number, shard.of));
    return std::filesystem::exists(lock) && storage::is_locked(lock).value_or(true);
}

/// The number of shards; 0: not computed in shards.
std::size_t shard_count(const OutputFolder& folder, const std::string& last_part) {
    std::set<std::size_t> running, all;
    for (const WrittenShard& shard : shards_in(folder.part_lock("").parent_path(), ""))
        if (is_running(folder, shard)) running.insert(shard.of);
    for (const WrittenShard& shard : shards_in(folder.root, "journal."))
        all.insert(shard.of);
    const std::set<std::size_t>& counts = running.empty() ? all : running;
    const bool is_complete_sweep = running.empty() && last_part.empty();
    return counts.size() == 1 && !is_complete_sweep ? *counts.begin() : 0;
}

} // namespace

ShardStates shard_states(const OutputFolder& folder, const std::vector<std::size_t>& open,
                         const std::string& last_part) {
    ShardStates states;
    states.of = shard_count(folder, last_part);
    for (std::size_t number = 1; number <= states.of; ++number) {
        if (is_running(folder, {number, states.of}))
            states.running.push_back(number);
        else if (std::ranges::any_of(open, [&](auto i) { return i % states.of == number - 1; }))
            states.to_start.push_back(number);
    }
    return states;
}

std::string shards_command_line(const std::string& run, const ShardStates& shards) {
    if (shards.to_start.size() == 1)
        return fmt::format("{} --shard {}/{}", run, shards.to_start.front(), shards.of);
    return fmt::format("for k in {}; do {} --shard $k/{}; done", fmt::join(shards.to_start, " "),
                       run, shards.of);
}

} // namespace shearwake::schedule
