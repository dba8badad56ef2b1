// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"

#include "base/json.hpp"
#include "base/text.hpp"
#include "parallel/agree.hpp"
#include "reduce/derived_tables.hpp"
#include "schedule/run/output_folder.hpp"
#include "schedule/run/progress.hpp"
#include "schedule/run/run.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"
#include "storage/journal/claims.hpp"
#include "studies/tables.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::app {
namespace {

struct StatusArguments {
    std::filesystem::path folder;
    bool json = false;
};

struct Tally {
    std::size_t done = 0, running = 0, interrupted = 0, failed = 0, left = 0;
    double seconds = 0.0; // of the complete cases, with the time to write their files
    std::vector<std::string> damaged;
    std::vector<std::string> not_valid; // complete cases whose readings are not valid
    std::size_t active_runs = 0;
    int teams = 1;                                      // of the active runs, or of the last one
    std::optional<schedule::RecordedProgress> progress; // of the active runs

    bool is_active() const { return active_runs > 0; }
    std::size_t to_do() const { return left + interrupted + running; }
    double seconds_per_case() const { return done > 0 ? seconds / static_cast<double>(done) : 0.0; }
    /// Time in s until the teams have computed all cases; nothing if it is unknown.
    std::optional<double> time_left_s() const {
        if (to_do() == 0) return 0.0;
        if (progress && progress->cases_per_second > 0.0)
            return static_cast<double>(to_do()) / progress->cases_per_second;
        return schedule::time_left_s(seconds / teams, static_cast<double>(done),
                                     static_cast<double>(done + to_do()));
    }
};

/// What the active `runs` state. A killed run leaves no final entry in the journal.
void add_runs(const std::vector<std::string>& runs, const storage::JournalContents& journal,
              const schedule::OutputFolder& folder, Tally& tally) {
    tally.active_runs = runs.size();
    int teams = 0;
    for (const std::string& run : runs)
        if (const auto open = journal.runs.find(run);
            open != journal.runs.end()) // else it has only begun
            teams += open->second;
    tally.teams = std::max(1, teams > 0 ? teams : journal.teams);
    tally.progress = schedule::recorded_progress(folder, runs);
}

Tally tally_of(const storage::PlanIndex& plan, const storage::JournalContents& journal,
               const schedule::OutputFolder& folder, storage::CaseIndex& index) {
    Tally tally;
    const std::vector<std::string> runs = storage::active_runs(folder.locks());
    add_runs(runs, journal, folder, tally);
    for (const storage::IndexedCase& c : plan.cases) {
        const auto entry = journal.cases.find(c.id);
        const bool known = entry != journal.cases.end();
        const storage::CaseDigest* digest = index.find(c.id);
        if (digest && digest->is_complete()) {
            ++tally.done;
            const double journal_s = known ? entry->second.seconds : 0.0;
            const double seconds = journal_s > 0.0 ? journal_s : digest->wall_s;
            if (seconds > 0.0) tally.seconds += seconds;
            if (!digest->is_valid()) tally.not_valid.push_back(c.id);
            continue;
        }
        if (digest) tally.damaged.push_back(c.id);
        if (known && entry->second.state == storage::CaseHistory::State::failed) {
            ++tally.failed;
            continue;
        }
        if (known && entry->second.state == storage::CaseHistory::State::started) {
            const bool is_running =
                std::ranges::count(runs, storage::claimed_by(folder.locks(), c.id)) > 0;
            ++(is_running ? tally.running : tally.interrupted);
        } else {
            ++tally.left;
        }
    }
    return tally;
}

/// What an output folder contains, for text and JSON.
struct State {
    storage::PlanIndex plan;
    storage::JournalContents journal;
    storage::CaseIndex index;
    Tally tally;
    std::string next;              // command, or an instruction
    std::size_t points_to_add = 0; // of adaptive axes, once all cases have ended
};

std::string next_step(const schedule::OutputFolder& folder, const State& state) {
    const Tally& tally = state.tally;
    const std::string run =
        state.journal.resumed_by.empty()
            ? schedule::run_command_line(folder.job(), state.journal.overrides, folder.root)
            : state.journal.resumed_by; // a study of `converge`
    if (tally.to_do() > 0 || state.points_to_add > 0)
        return tally.active_runs > 1 ? "wait for the active runs"
               : tally.is_active()   ? "wait for the active run"
                                     : run;
    if (tally.failed > 0) return run + " --retry-failed";
    return schedule::reduce_command_line(folder);
}

/// The cases that failed and have no complete file.
std::vector<const storage::IndexedCase*> failed_cases(State& state) {
    std::vector<const storage::IndexedCase*> failed;
    for (const storage::IndexedCase& c : state.plan.cases) {
        const auto entry = state.journal.cases.find(c.id);
        if (entry != state.journal.cases.end() && !state.index.is_complete(c.id) &&
            entry->second.state == storage::CaseHistory::State::failed)
            failed.push_back(&c);
    }
    return failed;
}

/// What the run does, or why there is none.
const char* state_of(const State& state) {
    const Tally& tally = state.tally;
    if (tally.is_active()) return "running";
    return tally.to_do() > 0 || state.points_to_add > 0 ? "stopped" : "finished";
}

void print_json(const schedule::OutputFolder& folder, State& state) {
    const Tally& tally = state.tally;
    Json failed = Json::array(), damaged = Json::array();
    for (const storage::IndexedCase* c : failed_cases(state))
        failed.push_back({{"id", c->id},
                          {"settings", storage::settings_json(c->settings)},
                          {"reason", state.journal.cases.at(c->id).reason}});
    for (const std::string& id : tally.damaged)
        damaged.push_back({{"id", id}, {"reason", state.index.find(id)->damage}});
    const bool has_times = tally.seconds > 0.0;
    const std::optional<double> left_s = tally.time_left_s();
    fmt::print("{}", json_document(
                         "status",
                         {{"folder", folder.root.string()},
                          {"name", state.plan.name},
                          {"title", state.plan.title},
                          {"cases", state.plan.cases.size()},
                          {"done", tally.done},
                          {"running", tally.running},
                          {"partial", tally.progress ? tally.progress->partial : 0.0},
                          {"failed", tally.failed},
                          {"remaining", tally.left + tally.interrupted},
                          {"interrupted", tally.interrupted},
                          {"is_active", tally.is_active()},
                          {"state", state_of(state)},
                          {"teams", tally.teams},
                          {"seconds_per_case", has_times ? Json(tally.seconds_per_case()) : Json()},
                          {"seconds_left", left_s ? Json(*left_s) : Json()},
                          {"failed_cases", failed},
                          {"damaged_cases", damaged},
                          {"not_valid", tally.not_valid.size()},
                          {"not_valid_cases", tally.not_valid},
                          {"next", state.next}}));
}

/// "remaining: about 5 min 07 s on 2 teams, at 30 s per case; the running cases are 20 % complete"
void print_remaining(const Tally& tally) {
    const std::optional<double> left_s = tally.time_left_s();
    if (!left_s || tally.to_do() == 0) return;
    fmt::print("remaining: about {} on {}", duration_text(*left_s), counted(tally.teams, "team"));
    if (tally.seconds > 0.0) fmt::print(", at {:.3g} s per case", tally.seconds_per_case());
    if (tally.progress && tally.running > 0)
        fmt::print("; the running case{} {:.0f} % complete", tally.running == 1 ? " is" : "s are",
                   100.0 * tally.progress->partial / static_cast<double>(tally.running));
    fmt::print("\n");
}

void print_text(const schedule::OutputFolder& folder, State& state) {
    auto& [plan, journal, index, tally, next, points_to_add] = state;
    fmt::print("{}{}{}\n", plan.name, plan.title.empty() ? "" : ": ", printable(plan.title));
    fmt::print("{}: {} done, {} running, {} failed, {} remaining",
               counted(plan.cases.size(), "case"), tally.done, tally.running, tally.failed,
               tally.left + tally.interrupted);
    if (tally.interrupted > 0) fmt::print(" ({} of them interrupted)", tally.interrupted);
    fmt::print("{}\n", tally.active_runs > 1
                           ? fmt::format("; {} runs are active", tally.active_runs)
                       : tally.is_active() ? "; a run is active"
                                           : "");
    print_remaining(tally);
    for (const storage::IndexedCase* c : failed_cases(state))
        fmt::print("failed {} {}: {}{}\n", c->id, storage::settings_text(c->settings),
                   journal.cases.at(c->id).reason,
                   std::filesystem::exists(folder.failure(c->id))
                       ? fmt::format(" (details: {})", folder.failure(c->id).string())
                       : "");
    for (const std::string& id : tally.damaged)
        fmt::print("damaged {}: {}; the next run computes it again\n", id, index.find(id)->damage);
    if (!tally.not_valid.empty())
        fmt::print("not valid: the readings of {}: {}; see the column note of the table\n",
                   counted(tally.not_valid.size(), "case"), fmt::join(tally.not_valid, ", "));
    if (points_to_add > 0)
        fmt::print("adaptive axes: {} to add\n", counted(points_to_add, "point"));
    if (std::filesystem::exists(folder.stop_file()))
        fmt::print("{} stops all runs: remove it to continue\n",
                   schedule::shell_word(folder.stop_file().string()));
    fmt::print("next: {}\n", next);
}

/// The points that the results ask for if all cases have ended.
std::size_t points_to_add(const schedule::OutputFolder& folder, const State& state) {
    if (state.plan.adaptive.empty() || state.tally.to_do() > 0) return 0;
    const reduce::Table table = studies::table_of(folder);
    std::size_t points = 0;
    for (const auto& axis : reduce::adaptive_states(state.plan, table).axes)
        points += axis.next.size();
    return points;
}

void print_status(const StatusArguments& arguments) {
    const schedule::OutputFolder folder = schedule::folder_of_results(arguments.folder);
    State state{.plan = storage::read_plan(folder.plan()),
                .journal = storage::read_journals(folder.root),
                .index = storage::CaseIndex(folder.root),
                .tally = {},
                .next = {},
                .points_to_add = 0};
    state.tally = tally_of(state.plan, state.journal, folder, state.index);
    state.points_to_add = points_to_add(folder, state);
    state.next = next_step(folder, state);
    if (arguments.json)
        print_json(folder, state);
    else
        print_text(folder, state);
    state.index.save();
}

ExitCode status_command(const StatusArguments& arguments, const Comm& world) {
    on_root(world, [&] { print_status(arguments); });
    return ExitCode::done;
}

} // namespace

void add_status(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<StatusArguments>(
        app, action, "status",
        "count done, running, failed and remaining cases, and estimate the remaining time",
        status_command);
    command.add_option("DIR", arguments.folder, "output folder of a run")->required();
    add_json(command, arguments.json);
}

} // namespace shearwake::app
