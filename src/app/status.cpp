// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"

#include "base/printable.hpp"
#include "parallel/agree.hpp"
#include "schedule/next_command.hpp"
#include "schedule/output_folder.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"
#include "storage/journal/run_lock.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::app {
namespace {

struct Tally {
    std::size_t done = 0, running = 0, interrupted = 0, failed = 0, left = 0;
    double seconds = 0.0; // of the complete cases
    std::vector<std::string> damaged;
    bool is_active = false; // a run currently computes into the folder
    std::string host;       // of that run; empty: this host, or unknown
};

Tally tally_of(const storage::PlanIndex& plan, const storage::JournalContents& journal,
               const schedule::OutputFolder& folder, storage::CaseIndex& index) {
    Tally tally;
    // A killed run leaves no final entry in the journal, but its lock has been released.
    tally.is_active = std::filesystem::exists(folder.run_lock())
                          ? storage::is_locked(folder.run_lock()).value_or(false)
                          : journal.running;
    if (!tally.is_active) {
        const auto holder = storage::holder_in(folder.run_lock().parent_path());
        tally.is_active = holder.has_value();
        if (holder) tally.host = holder->host;
    }
    for (const storage::IndexedCase& c : plan.cases) {
        const auto entry = journal.cases.find(c.id);
        const bool known = entry != journal.cases.end();
        const storage::CaseDigest* digest = index.find(c.id);
        if (digest && digest->whole()) {
            ++tally.done;
            if (digest->wall_s > 0.0) tally.seconds += digest->wall_s;
            continue;
        }
        if (digest) tally.damaged.push_back(c.id);
        if (known && entry->second.state == storage::CaseHistory::State::failed) {
            ++tally.failed;
        } else if (known && entry->second.state == storage::CaseHistory::State::started) {
            ++(tally.is_active ? tally.running : tally.interrupted);
        } else {
            ++tally.left;
        }
    }
    return tally;
}

void print_verified(const storage::PlanIndex& plan, storage::CaseIndex& index) {
    std::size_t intact = 0, unprotected = 0;
    for (const storage::IndexedCase& c : plan.cases)
        if (const storage::CaseDigest* digest = index.find(c.id); digest && digest->whole())
            ++(digest->has_checksum ? intact : unprotected);
    fmt::print("verified: {} case files match their checksums", intact);
    if (unprotected > 0)
        fmt::print(", {} were written by an earlier version without checksum", unprotected);
    fmt::print("\n");
}

/// Returns the number of damaged cases.
long print_status(const schedule::OutputFolder& folder, storage::CaseIndex::Trust trust) {
    const storage::PlanIndex plan = storage::read_plan(folder.plan());
    const storage::JournalContents journal = storage::read_journals(folder.root);
    storage::CaseIndex index(folder.root, trust);
    const Tally tally = tally_of(plan, journal, folder, index);
    fmt::print("{}: {}\n", plan.name, printable(plan.title));
    fmt::print("{} cases: {} done, {} running, {} failed, {} remaining", plan.cases.size(),
               tally.done, tally.running, tally.failed, tally.left + tally.interrupted);
    if (tally.interrupted > 0) fmt::print(" ({} of them interrupted)", tally.interrupted);
    fmt::print("{}{}\n", tally.is_active ? "; a run is active" : "",
               tally.host.empty() ? "" : " on " + tally.host);
    const std::size_t to_do = tally.left + tally.interrupted + tally.running;
    if (tally.done > 0 && to_do > 0)
        fmt::print("remaining: {:.3g} s of computing at {:.3g} s per case\n",
                   static_cast<double>(to_do) * tally.seconds / static_cast<double>(tally.done),
                   tally.seconds / static_cast<double>(tally.done));
    for (const storage::IndexedCase& c : plan.cases) {
        const auto entry = journal.cases.find(c.id);
        if (entry == journal.cases.end() || index.is_whole(c.id)) continue;
        if (entry->second.state == storage::CaseHistory::State::failed)
            fmt::print("failed {} {}: {}{}\n", c.id, storage::settings_text(c.settings),
                       entry->second.reason,
                       std::filesystem::exists(folder.failure(c.id))
                           ? fmt::format(" (details: {})", folder.failure(c.id).string())
                           : "");
    }
    for (const std::string& id : tally.damaged)
        fmt::print("damaged {}: {}; the next run computes it again\n", id, index.find(id)->damage);
    if (trust == storage::CaseIndex::Trust::checksum) print_verified(plan, index);
    if (std::filesystem::exists(folder.stop_file()))
        fmt::print("{} stops all runs: remove it to continue\n",
                   schedule::shell_word(folder.stop_file().string()));
    const std::string run =
        schedule::run_command_line(folder.job(), journal.overrides, folder.root);
    if (to_do > 0 && tally.is_active)
        fmt::print("next: wait for the active run\n");
    else if (to_do > 0)
        fmt::print("next: {}\n", run);
    else if (tally.failed > 0)
        fmt::print("next: {} --retry-failed\n", run);
    else
        fmt::print("next: {}\n", schedule::reduce_command_line(folder));
    index.save();
    return static_cast<long>(tally.damaged.size());
}

} // namespace

ExitCode status_command(const StatusArguments& arguments, const Comm& world) {
    long damaged = 0;
    on_root(world, [&] {
        damaged = print_status({arguments.folder}, arguments.verify
                                                       ? storage::CaseIndex::Trust::checksum
                                                       : storage::CaseIndex::Trust::size_and_time);
    });
    const bool fails = arguments.verify && world.broadcast(damaged) > 0;
    return fails ? ExitCode::some_cases_failed : ExitCode::done;
}

} // namespace shearwake::app
