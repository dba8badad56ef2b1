// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/closing_message.hpp"

#include "base/json.hpp"
#include "base/text.hpp"
#include "pipeline/case_checkpoints.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/run/deadline.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>

namespace shearwake::schedule {
namespace {

/// Largest number of cases that a message lists.
constexpr std::size_t most_listed = 5;

std::string counts_text(const Selection& selection, const WorkResult& result) {
    std::string text = fmt::format("{}: {} computed now, {} already complete, {} failed",
                                   counted(selection.total, "case"), result.done,
                                   selection.complete, result.failed + selection.failed_before);
    if (selection.not_selected > 0)
        text += fmt::format(", {} not selected", selection.not_selected);
    if (result.elsewhere > 0) text += fmt::format(", {} computed by other runs", result.elsewhere);
    return text;
}

/// Cases whose readings are not valid according to the warnings in their files.
std::vector<std::string> not_valid_cases(const OutputFolder& folder, const Plan& plan) {
    storage::CaseIndex index(folder.root);
    std::vector<std::string> ids;
    for (const PlannedCase& c : plan.cases)
        if (const storage::CaseDigest* digest = index.find(c.id); digest && !digest->is_valid())
            ids.push_back(c.id);
    return ids;
}

std::string validity_text(const OutputFolder& folder, const Plan& plan) {
    const std::size_t invalid = not_valid_cases(folder, plan).size();
    if (invalid == 0) return "";
    return fmt::format("\nthe readings of {} are not valid: see the column note of the table",
                       counted(invalid, "case"));
}

std::string stopped_text(const OutputFolder& folder, const Plan& plan, const Selection& selection,
                         const WorkResult& result, const RunArguments& arguments) {
    std::string text;
    if (result.postponed > 0)
        text += fmt::format("\n{} cases were not started, since they cannot finish within the "
                            "remaining time",
                            result.postponed);
    if (std::error_code ignored; std::filesystem::exists(folder.stop_file(), ignored))
        text += fmt::format("\n{} stops all runs: remove it to continue",
                            shell_word(folder.stop_file().string()));
    if (const std::string cases = resumable_cases(folder, plan, selection.work); !cases.empty())
        text += "\nthe next run resumes from checkpoints: " + cases;
    text += fmt::format("\nstopped early, all computed results are saved\nnext: {}",
                        run_command_line(arguments));
    if (stop_requested() && std::getenv("OMPI_COMM_WORLD_SIZE"))
        text += "\nexit code 75; if mpirun itself received the signal, it may exit with another "
                "code (1, 130 or 143)";
    return text;
}

/// The number of cases that were not selected, have no file and have not failed.
std::size_t left_to_others(const OutputFolder& folder, const Plan& plan,
                           const Selection& selection) {
    if (selection.not_selected == 0) return 0;
    std::error_code ignored;
    const auto open = std::ranges::count_if(selection.others, [&](std::size_t number) {
        const std::string& id = plan.cases[number].id;
        return !std::filesystem::exists(folder.case_file(id), ignored) &&
               !std::filesystem::exists(folder.failure(id), ignored);
    });
    return static_cast<std::size_t>(open);
}

/// What the user does next; empty if another command decides this.
std::string next_step(const OutputFolder& folder, const Plan& plan, const Selection& selection,
                      Ending ending, const RunArguments& arguments) {
    if (ending == Ending::stopped) return run_command_line(arguments);
    if (left_to_others(folder, plan, selection) > 0)
        return fmt::format("run the other cases, then {}", reduce_command_line(folder));
    return arguments.resumed_by.empty() ? reduce_command_line(folder) : "";
}

} // namespace

std::string resumable_cases(const OutputFolder& folder, const Plan& plan,
                            const std::vector<std::size_t>& numbers) {
    std::string text;
    std::size_t found = 0;
    storage::RunWatch runs(folder.locks());
    for (const std::size_t number : numbers) {
        const std::string& id = plan.cases[number].id;
        const std::string run = storage::claimed_by(folder.locks(), id);
        if (!run.empty() && runs.look(run) != storage::RunWatch::State::ended) continue;
        const double seconds =
            pipeline::seconds_saved(folder.checkpoints(id), {id, pipeline::program_git_id()});
        if (!(seconds > 0.0) || ++found > most_listed) continue;
        text += fmt::format("{}case {} ({} computed)", text.empty() ? "" : ", ", id,
                            duration_text(seconds));
    }
    if (found > most_listed) text += fmt::format(" and {} more", found - most_listed);
    return text;
}

std::string closing_message(const OutputFolder& folder, const Plan& plan,
                            const Selection& selection, const WorkResult& result, Ending ending,
                            const RunArguments& arguments) {
    std::string text = counts_text(selection, result);
    if (ending == Ending::stopped)
        return text + stopped_text(folder, plan, selection, result, arguments);
    const long left = static_cast<long>(selection.work.size()) - result.done - result.failed -
                      result.postponed - result.elsewhere;
    if (left > 0)
        text += fmt::format("\n{} cases were not started: {} computes them", left,
                            run_command_line(arguments));
    if (selection.failed_before > 0)
        text += "\ncases that failed before are only retried with --retry-failed";
    if (result.failed + selection.failed_before > 0)
        text += "\nreasons: shearwake status " + shell_word(folder.root.string());
    if (result.failed_files > 0)
        text += fmt::format("\n{} of them failed because of files or disks: rerun the command to "
                            "retry them",
                            result.failed_files);
    text += validity_text(folder, plan);
    text += "\nresults: " + folder.cases().string();
    const std::size_t others = left_to_others(folder, plan, selection);
    if (others > 0)
        text += fmt::format("\n{} of the sweep that this run did not select {} not complete",
                            counted(others, "case"), others == 1 ? "is" : "are");
    if (arguments.is_round) return text;
    if (const std::string next = next_step(folder, plan, selection, ending, arguments);
        !next.empty())
        text += "\nnext: " + next;
    return text;
}

Json closing_document(const OutputFolder& folder, const config::Job& job,
                      const Selection& selection, const WorkResult& result, Ending ending,
                      const RunArguments& arguments) {
    const storage::JournalContents journal = storage::read_journals(folder.root);
    Json failed = Json::array();
    std::error_code ignored;
    for (const PlannedCase& c : job.plan.cases) {
        const auto entry = journal.cases.find(c.id);
        if (entry != journal.cases.end() &&
            entry->second.state == storage::CaseHistory::State::failed &&
            !std::filesystem::exists(folder.case_file(c.id), ignored))
            failed.push_back({{"id", c.id},
                              {"settings", storage::settings_json(c.settings)},
                              {"reason", entry->second.reason}});
    }
    const long not_started =
        static_cast<long>(selection.work.size()) - result.done - result.failed - result.elsewhere;
    return {{"job", arguments.job.string()},
            {"name", job.plan.name},
            {"folder", folder.root.string()},
            {"state", ending == Ending::stopped ? "stopped" : "finished"},
            {"cases", selection.total},
            {"computed", result.done},
            {"already_complete", selection.complete},
            {"failed", result.failed + selection.failed_before},
            {"by_other_runs", result.elsewhere},
            {"not_selected", selection.not_selected},
            {"not_completed", std::max(0L, not_started)},
            {"failed_cases", failed},
            {"not_valid_cases", not_valid_cases(folder, job.plan)},
            {"diagnostics", config::json_of(job.diagnostics)},
            {"adaptive", Json::array()}, // adaptive_run adds sentences
            {"next", next_step(folder, job.plan, selection, ending, arguments)}};
}

} // namespace shearwake::schedule
