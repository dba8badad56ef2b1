// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/select_cases.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <sstream>

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

void must_exist(const std::vector<std::string>& only, const Plan& plan) {
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
    must_exist(arguments.only, plan);
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
        if (index.is_whole(id)) {
            ++selection.whole;
            selection.there.push_back(i);
            continue;
        }
        const auto history = journal.cases.find(id);
        const bool failed = history != journal.cases.end() &&
                            history->second.state == storage::CaseHistory::State::failed &&
                            history->second.blame == storage::Blame::case_itself;
        if (failed && !arguments.retry_failed)
            ++selection.failed_before;
        else
            selection.work.push_back(i);
    }
    return selection;
}

Selection share(const Selection& selection, const Comm& world) {
    std::ostringstream text;
    text << selection.total << ' ' << selection.whole << ' ' << selection.failed_before << ' '
         << selection.not_selected;
    for (const std::size_t index : selection.work)
        text << ' ' << index;
    std::istringstream words(world.broadcast(text.str()));
    Selection shared;
    words >> shared.total >> shared.whole >> shared.failed_before >> shared.not_selected;
    for (std::size_t index = 0; words >> index;)
        shared.work.push_back(index);
    return shared;
}

} // namespace shearwake::schedule
