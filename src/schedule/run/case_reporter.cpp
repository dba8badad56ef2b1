// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/case_reporter.hpp"

#include "pipeline/provenance.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"
#include "storage/journal/plan_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace shearwake::schedule {
namespace {

/// After this number of consecutive file errors, further cases would probably fail as well.
constexpr int most_file_failures_in_a_row = 3;

/// The name of this host if it differs from that of rank 0, otherwise empty. Collective.
std::string further_host(const Comm& world) {
    const std::string mine = storage::host_name();
    return world.broadcast(mine) == mine ? "" : mine;
}

/// The same for all cases of a sweep whose warnings differ in their numbers only.
std::string without_digits(std::string text) {
    std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
    return text;
}

} // namespace

CaseReporter::CaseReporter(const WorkList& list, RunState& state, const Comm& world,
                           const Comm& team, Progress& progress)
    : list_(list), state_(state), team_(team), progress_(progress), host_(further_host(world)),
      journal_(list.folder.journal(list.run, host_)) {}

void CaseReporter::report(const std::string& text) {
    case_log_.push_back(storage::timestamp() + " " + text);
    progress_.report(text);
}

void CaseReporter::inform(const std::string& text) {
    if (!list_.arguments.quiet) progress_.report(text);
}

void CaseReporter::record_completed(const PlannedCase& planned,
                                    const pipeline::CaseOutcome& outcome) {
    journal_.finished(planned.id, outcome.seconds, engine_name(planned.physics.solver),
                      outcome.checksum);
    storage::add_to_index(list_.folder.index(list_.run, host_), list_.folder.case_file(planned.id),
                          outcome.digest);
    std::error_code ignored;
    std::filesystem::remove(list_.folder.failure(planned.id), ignored);
}

void CaseReporter::report_completed(const PlannedCase& planned,
                                    const pipeline::CaseOutcome& outcome) try {
    if (!team_.is_root() || list_.arguments.quiet) return;
    const bool is_verbose = list_.arguments.verbose;
    for (const Remark& remark : outcome.discovered)
        if (reported_.insert(is_verbose ? remark.message : without_digits(remark.message)).second)
            progress_.report(fmt::format("case {}: {}: {}: {}{}", planned.id,
                                         remark.severity == Severity::error ? "error" : "warning",
                                         remark.key, remark.message,
                                         is_verbose ? "" : " (the table lists it for all cases)"));
    if (!is_verbose) return;
    const engines::SolverReport& solver = outcome.solver;
    std::vector<std::string> news;
    if (solver.iterations > 0)
        news.push_back(fmt::format("{} steps, {} iterations, {} at most in a step", solver.steps,
                                   solver.iterations, solver.most_iterations));
    for (const std::string& note : solver.notes)
        if (reported_.insert(note).second) news.push_back(note);
    if (!news.empty())
        progress_.report(fmt::format("case {}: {}", planned.id, fmt::join(news, "; ")));
} catch (const std::bad_alloc&) { // the case is complete
}

void CaseReporter::record_failed(const PlannedCase& planned, const std::string& reason,
                                 storage::Cause cause) {
    state_.add(RunState::failed);
    try {
        report(fmt::format("case {} failed: {}", planned.id, reason));
        journal_.failed(planned.id, reason, cause);
        write_failure(planned, reason);
    } catch (const std::exception& error) {
        progress_.report(fmt::format("and this could not be recorded: {}", error.what()));
    }
    if (list_.arguments.fail_fast) state_.give_up();
    if (cause != storage::Cause::files) return;
    state_.add(RunState::failed_files);
    state_.look_for_folder(RunState::Look::now);
    if (state_.read(RunState::folder_removed) == 0 &&
        ++file_failures_in_a_row_ == most_file_failures_in_a_row) {
        progress_.report(
            fmt::format("file errors ended {} cases in a row; no further case is started",
                        most_file_failures_in_a_row));
        state_.give_up();
    }
}

/// Keeps what is needed to examine the case: reason, log, inputs, and the command that retries it.
void CaseReporter::write_failure(const PlannedCase& planned, const std::string& reason) const {
    storage::make_directory(list_.folder.failure(planned.id).parent_path());
    RunArguments again = list_.arguments;
    again.only = {planned.id};
    std::string text =
        fmt::format("case {} failed at {} on {}, {} ranks, shearwake {}\nreason: {}\n"
                    "to retry: {} --retry-failed\n\nlog:\n",
                    planned.id, storage::timestamp(), storage::host_name(), team_.size(),
                    pipeline::program_git_id(), reason, run_command_line(again));
    for (const std::string& line : case_log_)
        text += "  " + line + "\n";
    text += fmt::format("\nsettings:\n{}\n\ncase (SI):\n{}",
                        storage::settings_text(planned.settings), canonical_text(planned.physics));
    storage::write_file(list_.folder.failure(planned.id), text);
}

} // namespace shearwake::schedule
