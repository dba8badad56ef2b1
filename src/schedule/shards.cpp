// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/shards.hpp"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <set>

namespace shearwake::schedule {

ShardStates shard_states(const OutputFolder& folder, const std::vector<std::size_t>& open) {
    std::set<std::size_t> counts;
    std::error_code missing; // a missing folder has no journals
    for (const auto& entry : std::filesystem::directory_iterator(folder.root, missing)) {
        std::size_t number = 0, of = 0;
        if (std::sscanf(entry.path().filename().c_str(), "journal.%zu-of-%zu", &number, &of) == 2)
            counts.insert(of);
    }
    ShardStates states;
    if (counts.size() != 1 || *counts.begin() == 0) return states;
    states.of = *counts.begin();
    for (std::size_t number = 1; number <= states.of; ++number) {
        const auto lock = folder.part_lock(fmt::format("{}-of-{}", number, states.of));
        if (std::filesystem::exists(lock) && storage::is_locked(lock).value_or(true))
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
