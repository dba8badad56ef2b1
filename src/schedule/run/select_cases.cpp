// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/select_cases.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fmt/format.h>
#include <set>

namespace shearwake::schedule {

namespace {

struct Shard {
    std::size_t number = 1, of = 1;
};

Shard parse_shard(const std::string& text) {
    Shard shard;
    if (text.empty()) return shard;
    const char* end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, shard.number);
    const bool slash = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
    const auto second = slash ? std::from_chars(first.ptr + 1, end, shard.of) : first;
    const bool fine = slash && second.ec == std::errc() && second.ptr == end && shard.number >= 1 &&
                      shard.number <= shard.of;
    if (!fine)
        throw UsageError("--shard " + text + ": must be I/N with 1 <= I <= N, for example 2/8");
    return shard;
}

void require_cases(const std::vector<std::string>& only, const Plan& plan) {
    std::vector<std::string> ids;
    for (const PlannedCase& c : plan.cases)
        ids.push_back(c.id);
    for (const std::string& id : only) {
        if (std::find(ids.begin(), ids.end(), id) != ids.end()) continue;
        const auto meant = nearest(id, ids);
        throw UsageError(
            fmt::format("--only {}: no such case{}; shearwake plan lists the ids of all cases", id,
                        meant ? "; did you mean " + *meant + "?" : ""));
    }
}

} // namespace

std::string part_name(const RunArguments& arguments) {
    const Shard shard = parse_shard(arguments.shard);
    if (!arguments.shard.empty()) return fmt::format("{}-of-{}", shard.number, shard.of);
    return arguments.only.empty() ? "" : "only-" + arguments.only.front();
}

Selection select_cases(const Plan& plan, const storage::JournalContents& journal,
                       storage::CaseIndex& index, const RunArguments& arguments) {
    const Shard shard = parse_shard(arguments.shard);
    require_cases(arguments.only, plan);
    Selection selection{.total = plan.cases.size()};
    for (std::size_t i = 0; i < plan.cases.size(); ++i) {
        const std::string& id = plan.cases[i].id;
        const bool wanted =
            arguments.only.empty() ||
            std::find(arguments.only.begin(), arguments.only.end(), id) != arguments.only.end();
        if (!wanted || i % shard.of != shard.number - 1) {
            ++selection.not_selected;
            selection.others.push_back(i);
            continue;
        }
        if (index.is_complete(id)) {
            ++selection.complete;
            selection.there.push_back(i);
            continue;
        }
        const auto history = journal.cases.find(id);
        const bool failed = history != journal.cases.end() &&
                            history->second.state == storage::CaseHistory::State::failed &&
                            history->second.cause == storage::Cause::case_itself;
        if (failed && !arguments.retry_failed)
            ++selection.failed_before;
        else
            selection.work.push_back(i);
    }
    return selection;
}

void share(Selection& selection, const Comm& world) {
    std::vector<long> work(selection.work.begin(), selection.work.end());
    world.broadcast(work);
    selection.work.assign(work.begin(), work.end());
    selection.failed_before = world.broadcast(selection.failed_before);
}

namespace {

/// The shards that have a file in a folder: `prefix`, "2-of-8", and any end.
std::vector<Shard> shards_in(const std::filesystem::path& folder, const std::string& prefix) {
    std::vector<Shard> found;
    std::error_code missing; // a missing folder has none
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
        Shard shard;
        const std::string name = entry.path().filename().string();
        if (name.starts_with(prefix) &&
            std::sscanf(name.c_str() + prefix.size(), "%zu-of-%zu", &shard.number, &shard.of) ==
                2 &&
            shard.of > 0)
            found.push_back(shard);
    }
    return found;
}

bool is_running(const OutputFolder& folder, const Shard& shard) {
    const auto lock = folder.part_lock(fmt::format("{}-of-{}", shard.number, shard.of));
    return std::filesystem::exists(lock) && storage::is_locked(lock).value_or(true);
}

/// The number of shards; 0: not computed in shards.
std::size_t shard_count(const OutputFolder& folder, const std::string& last_part) {
    std::set<std::size_t> running, all;
    for (const Shard& shard : shards_in(folder.part_lock("").parent_path(), ""))
        if (is_running(folder, shard)) running.insert(shard.of);
    for (const Shard& shard : shards_in(folder.root, "journal."))
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
