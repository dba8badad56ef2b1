#include "sweep/commands.hpp"

#include "io/case_index.hpp"
#include "io/journal.hpp"
#include "io/plan_file.hpp"
#include "io/run_lock.hpp"
#include "parallel/agree.hpp"
#include "sweep/next_command.hpp"
#include "sweep/output_folder.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake {
namespace {

struct Tally {
    std::size_t done = 0, running = 0, interrupted = 0, failed = 0, left = 0;
    double seconds = 0.0; // of the cases done
    std::vector<std::string> damaged;
    bool at_work = false; // a run computes into the folder now
    std::string host;     // of that run; empty: this one, or of an unknown
};

Tally tally_of(const PlanIndex& plan, const JournalContents& journal, const OutputFolder& folder,
               CaseIndex& index) {
    Tally tally;
    // A killed run could not say that it ended; its lock is gone all the same, or counts no more.
    tally.at_work = std::filesystem::exists(folder.run_lock())
                        ? is_locked(folder.run_lock()).value_or(false)
                        : journal.running;
    if (!tally.at_work) {
        const auto holder = holder_in(folder.run_lock().parent_path());
        tally.at_work = holder.has_value();
        if (holder) tally.host = holder->host;
    }
    for (const IndexedCase& c : plan.cases) {
        const auto entry = journal.cases.find(c.id);
        const bool known = entry != journal.cases.end();
        const CaseDigest* digest = index.find(c.id);
        if (digest && digest->whole()) {
            ++tally.done;
            if (digest->wall_s > 0.0) tally.seconds += digest->wall_s;
            continue;
        }
        if (digest) tally.damaged.push_back(c.id);
        if (known && entry->second.state == CaseHistory::State::failed) {
            ++tally.failed;
        } else if (known && entry->second.state == CaseHistory::State::started) {
            ++(tally.at_work ? tally.running : tally.interrupted);
        } else {
            ++tally.left;
        }
    }
    return tally;
}

void print_status(const OutputFolder& folder) {
    const PlanIndex plan = read_plan(folder.plan());
    const JournalContents journal = read_journals(folder.root);
    CaseIndex index(folder.root);
    const Tally tally = tally_of(plan, journal, folder, index);
    fmt::print("{}: {}\n", plan.name, plan.title);
    fmt::print("{} cases: {} done, {} running, {} failed, {} left", plan.cases.size(), tally.done,
               tally.running, tally.failed, tally.left + tally.interrupted);
    if (tally.interrupted > 0) fmt::print(" ({} of them interrupted)", tally.interrupted);
    fmt::print("{}{}\n", tally.at_work ? "; a run is at work" : "",
               tally.host.empty() ? "" : " on " + tally.host);
    const std::size_t to_do = tally.left + tally.interrupted + tally.running;
    if (tally.done > 0 && to_do > 0)
        fmt::print("to go: {:.3g} s of computing at {:.3g} s a case\n",
                   static_cast<double>(to_do) * tally.seconds / static_cast<double>(tally.done),
                   tally.seconds / static_cast<double>(tally.done));
    for (const IndexedCase& c : plan.cases) {
        const auto entry = journal.cases.find(c.id);
        if (entry == journal.cases.end() || index.is_whole(c.id)) continue;
        if (entry->second.state == CaseHistory::State::failed)
            fmt::print("failed {} {}: {}{}\n", c.id, settings_text(c.settings),
                       entry->second.reason,
                       std::filesystem::exists(folder.failure(c.id))
                           ? fmt::format(" (all of it: {})", folder.failure(c.id).string())
                           : "");
    }
    for (const std::string& id : tally.damaged)
        fmt::print("damaged {}: its file is not whole; a run computes it again\n", id);
    if (std::filesystem::exists(folder.stop_file()))
        fmt::print("{} asks for a stop, no run begins a case: remove it to go on\n",
                   shell_word(folder.stop_file().string()));
    const std::string run = run_command_line(folder.job(), journal.overrides, folder.root);
    if (to_do > 0 && tally.at_work)
        fmt::print("next: wait for the run that is at work\n");
    else if (to_do > 0)
        fmt::print("next: {}\n", run);
    else if (tally.failed > 0)
        fmt::print("next: {} --retry-failed\n", run);
    else
        fmt::print("next: {}\n", reduce_command_line(folder));
    index.save();
}

} // namespace

ExitCode status_command(const std::filesystem::path& folder, const Comm& world) {
    on_root(world, [&] { print_status({folder}); });
    return ExitCode::done;
}

} // namespace shearwake
