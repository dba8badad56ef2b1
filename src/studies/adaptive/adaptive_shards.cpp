// SPDX-License-Identifier: BSD-3-Clause
#include "studies/adaptive/adaptive_shards.hpp"

#include "base/error.hpp"
#include "schedule/run/deadline.hpp"
#include "schedule/run/select_cases.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fmt/format.h>
#include <thread>

namespace shearwake::adaptive {
namespace {

constexpr auto between_looks = std::chrono::milliseconds(500);
constexpr const char* presence_prefix = "adaptive-";

} // namespace

OtherShards::OtherShards(schedule::OutputFolder folder, const schedule::RunArguments& arguments,
                         const schedule::Deadline& deadline)
    : folder_(std::move(folder)),
      part_(arguments.shard.empty() ? "" : schedule::part_name(arguments)), deadline_(deadline) {
    if (part_.empty()) return;
    storage::make_directory(folder_.run_lock().parent_path());
    presence_ = std::make_unique<storage::RunLock>(folder_.part_lock(presence_prefix + part_),
                                                   storage::RunLock::Sharing::alone);
}

std::vector<std::size_t> OtherShards::open_cases(const Plan& plan) const {
    const storage::JournalContents journal = storage::read_journals(folder_.root);
    storage::CaseIndex index(folder_.root);
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < plan.cases.size(); ++i) {
        const std::string& id = plan.cases[i].id;
        const auto history = journal.cases.find(id);
        const bool failed = history != journal.cases.end() &&
                            history->second.state == storage::CaseHistory::State::failed;
        if (!failed && !index.is_complete(id)) open.push_back(i);
    }
    return open;
}

/// Whether another shard holds its lock `<prefix>K-of-N`.
bool OtherShards::is_any_running(const std::string& prefix) const {
    std::error_code missing;
    for (const auto& entry :
         std::filesystem::directory_iterator(folder_.run_lock().parent_path(), missing)) {
        const std::string name = entry.path().filename().string();
        std::size_t number = 0, of = 0;
        const bool is_part =
            name.starts_with(prefix) &&
            std::sscanf(name.c_str() + prefix.size(), "%zu-of-%zu", &number, &of) == 2;
        if (is_part && name != prefix + part_ && storage::is_locked(entry.path()).value_or(false))
            return true;
    }
    return false;
}

bool OtherShards::is_extended(const Plan& plan) const {
    return storage::read_plan(folder_.plan()).cases.size() > plan.cases.size();
}

OtherShards::Outcome OtherShards::wait(const Plan& plan) const {
    if (part_.empty()) return {};
    while (true) {
        // The locks are read first: a shard may complete its cases and end in between.
        const bool is_any_present = is_any_running(presence_prefix);
        const std::size_t open = open_cases(plan).size();
        if (is_extended(plan)) return {.is_extended = true, .reason = ""};
        // Nobody may compute while the plan is extended.
        if (open == 0 && !is_any_running("")) return {};
        if (open > 0 && !is_any_present)
            return {.is_extended = false,
                    .reason = fmt::format(
                        "{} cases of other shards are not complete; the points of the next round "
                        "follow from them: run the other shards at the same time, or rerun this "
                        "command after them",
                        open)};
        std::error_code none;
        if (schedule::stop_requested() || std::filesystem::exists(folder_.stop_file(), none))
            return {.is_extended = false,
                    .reason = "stopped early, all computed results are saved"};
        if (deadline_.left_s() <= 0.0)
            return {.is_extended = false,
                    .reason = "the time limit is reached, all results are saved"};
        std::this_thread::sleep_for(between_looks);
    }
}

} // namespace shearwake::adaptive
