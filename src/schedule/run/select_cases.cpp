// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/select_cases.hpp"

#include "base/error.hpp"
#include "base/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::schedule {

namespace {

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

Selection select_cases(const Plan& plan, const storage::JournalContents& journal,
                       storage::CaseIndex& index, const RunArguments& arguments) {
    require_cases(arguments.only, plan);
    Selection selection{.total = plan.cases.size()};
    for (std::size_t i = 0; i < plan.cases.size(); ++i) {
        const std::string& id = plan.cases[i].id;
        const bool wanted =
            arguments.only.empty() ||
            std::find(arguments.only.begin(), arguments.only.end(), id) != arguments.only.end();
        if (!wanted) {
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

} // namespace shearwake::schedule
