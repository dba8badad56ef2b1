// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/closing_message.hpp"

#include "base/text.hpp"
#include "pipeline/case_checkpoints.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/next_command.hpp"
#include "schedule/stop_signal.hpp"
#include "storage/case_file/case_index.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>

namespace shearwake::schedule {
namespace {

/// Largest number of cases that a message lists.
constexpr std::size_t most_listed = 5;

std::string cases_text(std::size_t count) {
    return fmt::format("{} case{}", count, count == 1 ? "" : "s");
}

std::string counts_text(const Selection& selection, const WorkResult& result) {
    std::string text = fmt::format("{}: {} computed now, {} already complete, {} failed",
                                   cases_text(selection.total), result.done, selection.whole,
                                   result.failed + selection.failed_before);
    if (selection.not_selected > 0)
        text += fmt::format(", {} not selected", selection.not_selected);
    if (result.elsewhere > 0) text += fmt::format(", {} by other runs", result.elsewhere);
    return text;
}

/// Cases whose readings are not valid according to the warnings in their files.
std::string validity_text(const OutputFolder& folder, const Plan& plan) {
    storage::CaseIndex index(folder.root);
    const auto invalid = std::ranges::count_if(plan.cases, [&](const PlannedCase& c) {
        const storage::CaseDigest* digest = index.find(c.id);
        return digest && !digest->is_valid();
    });
    if (invalid == 0) return "";
    return fmt::format("\nthe readings of {} are not valid: see the column note of the table",
                       cases_text(static_cast<std::size_t>(invalid)));
}

std::string stopped_text(const OutputFolder& folder, const Plan& plan, const Selection& selection,
                         const WorkResult& result, const RunArguments& arguments) {
    std::string text;
    if (result.put_off > 0)
        text += fmt::format("\n{} cases were not started, since they cannot finish within the "
                            "remaining time",
                            result.put_off);
    if (std::error_code none; std::filesystem::exists(folder.stop_file(), none))
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

/// The number of cases that were not selected and have no file.
std::size_t left_to_others(const OutputFolder& folder, const Plan& plan,
                           const Selection& selection) {
    if (selection.not_selected == 0) return 0;
    std::error_code none;
    const auto open = std::ranges::count_if(selection.others, [&](std::size_t number) {
        return !std::filesystem::exists(folder.case_file(plan.cases[number].id), none);
    });
    return static_cast<std::size_t>(open);
}

} // namespace

std::string resumable_cases(const OutputFolder& folder, const Plan& plan,
                            const std::vector<std::size_t>& numbers) {
    std::string text;
    std::size_t found = 0;
    for (const std::size_t number : numbers) {
        const std::string& id = plan.cases[number].id;
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
                      result.put_off - result.elsewhere;
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
                            cases_text(others), others == 1 ? "is" : "are");
    if (arguments.is_round) return text;
    if (others > 0)
        text +=
            fmt::format("\nnext: run the other {}, then {}",
                        arguments.shard.empty() ? "cases" : "shards", reduce_command_line(folder));
    else if (arguments.resumed_by.empty())
        text += "\nnext: " + reduce_command_line(folder);
    return text;
}

} // namespace shearwake::schedule
