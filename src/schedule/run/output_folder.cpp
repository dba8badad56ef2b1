// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/output_folder.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "config/document/tree.hpp"
#include "pipeline/case_checkpoints.hpp"
#include "pipeline/provenance.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <fmt/format.h>
#include <set>

namespace shearwake::schedule {
namespace {

/// Another process copies files of a study at most.
constexpr auto patience_with_others = std::chrono::minutes(1);

/// Whether a run creates files or folders of this name.
bool is_ours(const std::string& name) {
    constexpr std::array names = {"cases",     "job.toml", "plan.json",         "STOP",
                                  "slurm",     "failed",   "checkpoints",       "locks",
                                  "tables",    "converge", "converge.json",     "converge.md",
                                  "basis",     "optimise", "robustness",        "uncertainty.json",
                                  "scan.json", "scan.f64", "scan-request.json", "refinements.json"};
    if (std::ranges::find(names, name) != names.end() || name.ends_with(".part")) return true;
    if (name.starts_with("._") || name == ".DS_Store") return true; // of macOS
    if (name.starts_with("progress.") && name.ends_with(".json")) return true;
    return (name.starts_with("journal.") || name.starts_with("index.")) && name.ends_with(".jsonl");
}

/// Whether a folder without a plan contains files that no run creates.
bool has_foreign_files(const OutputFolder& folder) {
    for (const auto& entry : std::filesystem::directory_iterator(folder.root))
        if (!is_ours(entry.path().filename().string())) return true;
    return false;
}

/// The names of case files that do not belong to a case of the plan.
std::vector<std::string> foreign_cases(const Plan& plan, const OutputFolder& folder) {
    std::set<std::string> ids;
    for (const PlannedCase& c : plan.cases)
        ids.insert(c.id);
    std::vector<std::string> names;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder.cases(), ignored))
        if (const std::string id = storage::id_of_file(entry.path());
            !id.empty() && !ids.contains(id))
            names.push_back(entry.path().filename().string());
    return names;
}

/// A damaged plan may be rewritten only if all results in the folder belong to cases of this job.
void require_plan(const Plan& plan, const OutputFolder& folder) {
    if (const std::vector<std::string> foreign = foreign_cases(plan, folder); !foreign.empty())
        throw UsageError(fmt::format("{} is damaged, and {} does not belong to a case of this job; "
                                     "run the job of this folder, or choose another folder with "
                                     "--out",
                                     folder.plan().string(), foreign.front()),
                         ExitCode::environment);
}

/// A sentence about case files that do not belong to a case of the plan; empty without them.
std::string cases_left_out(const Plan& plan, const OutputFolder& folder) {
    const std::size_t count = foreign_cases(plan, folder).size();
    if (count == 0) return {};
    return fmt::format("{} in {} {} not in this job and {} unused", counted(count, "case file"),
                       folder.cases().string(), count == 1 ? "is" : "are",
                       count == 1 ? "remains" : "remain");
}

/// Whether the process that writes a temporary file has ended. On another host, a file older than a
/// minute is assumed to be abandoned.
bool is_abandoned(const std::filesystem::path& part) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    return storage::has_ended(storage::process_in(part)) ||
           fs::file_time_type::clock::now() - fs::last_write_time(part, ignored) >
               std::chrono::minutes(1);
}

/// Removes a temporary file that an ended process has left; that of a case remains if a checkpoint
/// needs it.
void remove_part(const OutputFolder& folder, const std::filesystem::path& part,
                 storage::CaseClaims& claims) {
    std::error_code ignored;
    const std::string name = part.filename().string();
    const auto end = name.find(".h5.");
    if (end == std::string::npos) {
        if (is_abandoned(part)) std::filesystem::remove(part, ignored);
        return;
    }
    const std::string id = name.substr(0, end);
    if (claims.claim(id) == storage::CaseClaims::Answer::refused) return;
    if (!pipeline::has_checkpoint(folder.checkpoints(id))) std::filesystem::remove(part, ignored);
    claims.release(id);
}

} // namespace

std::filesystem::path OutputFolder::journal(const std::string& run, const std::string& host) const {
    return root / storage::journal_name(run, host);
}

std::filesystem::path OutputFolder::index(const std::string& run, const std::string& host) const {
    return root / storage::index_name(storage::journal_name(run, host));
}

std::vector<std::string> OutputFolder::recorded_runs() const {
    constexpr std::string_view first = "progress.", last = ".json";
    std::vector<std::string> runs;
    std::error_code ignored; // a run may end at any time
    for (const auto& entry : std::filesystem::directory_iterator(root, ignored)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(first) && name.ends_with(last) && !storage::is_stray(name) &&
            name.size() > first.size() + last.size())
            runs.push_back(name.substr(first.size(), name.size() - first.size() - last.size()));
    }
    return runs;
}

bool OutputFolder::has_lost_plan() const {
    std::error_code error;
    return !std::filesystem::exists(plan(), error) && !error;
}

OutputFolder folder_of_results(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return {path};
    if (path.extension() != ".toml")
        throw UsageError(fmt::format("{} is a file; give the output folder of a run, for example "
                                     "out/quickstart",
                                     path.string()));
    config::DiagnosticList diagnostics;
    const config::NodePtr job = config::parse_toml(
        storage::read_file(path, storage::largest_user_text_B), path.string(), diagnostics);
    const config::NodePtr name = job ? config::find(job, {{"job"}, {"name"}}) : nullptr;
    const auto* word = name ? std::get_if<std::string>(&name->value) : nullptr;
    throw UsageError(fmt::format(
        "{} is a job file; give the output folder of its run, by default {}", path.string(),
        word && is_file_name(*word) ? "out/" + *word : "out/<job name>"));
}

std::string prepare_output(const OutputFolder& folder, const config::Job& job, OtherPlan other) {
    namespace fs = std::filesystem;
    if (!fs::exists(folder.plan()) && fs::exists(folder.root) && has_foreign_files(folder))
        throw UsageError(fmt::format("{} is not empty and contains no plan of shearwake; choose "
                                     "another folder with --out",
                                     folder.root.string()));
    storage::make_directory(folder.locks());
    const storage::FileLock lock(storage::folder_lock(folder.locks()), patience_with_others);
    const std::string text = storage::plan_text(job.plan);
    std::string warning;
    if (fs::exists(folder.plan())) {
        const std::string before = storage::read_file(folder.plan());
        storage::PlanMatch match = storage::compare_plan(before, job.plan);
        const bool is_replaced = other == OtherPlan::replaced &&
                                 match == storage::PlanMatch::another &&
                                 storage::read_plan(folder.plan()).name == job.plan.name;
        if (is_replaced) match = storage::PlanMatch::extended;
        if (match == storage::PlanMatch::damaged) {
            require_plan(job.plan, folder);
            storage::write_file(folder.plan(), text);
            warning = fmt::format("{} was damaged and has been rewritten from this job",
                                  folder.plan().string());
        }
        if (match == storage::PlanMatch::extended) {
            if (is_replaced) storage::require_no_run(folder.locks());
            storage::write_file(folder.job(), job.text);
            storage::write_file(folder.plan(), text);
            if (is_replaced) warning = cases_left_out(job.plan, folder);
        }
        if (match == storage::PlanMatch::same && fs::exists(folder.job()) &&
            storage::read_file(folder.job()) != job.text)
            storage::write_file(folder.job(), job.text); // for example with other labels
        if (match == storage::PlanMatch::another)
            throw UsageError(
                fmt::format("{} contains the results of another plan (its plan.json differs "
                            "from that of this job); {}; or choose another folder with --out, or "
                            "remove this one",
                            folder.root.string(),
                            other == OtherPlan::replaced
                                ? "--extend requires the same job.name"
                                : "--extend keeps the cases that this job contains as well"));
    }
    storage::make_directory(folder.cases());
    if (!fs::exists(folder.plan())) storage::write_file(folder.job(), job.text);
    // The plan is written last, since a folder without a plan counts as new.
    if (!fs::exists(folder.plan())) storage::write_file(folder.plan(), text);
    return warning;
}

void remove_other_plan(const OutputFolder& folder, const Plan& plan) {
    storage::make_directory(folder.locks());
    const storage::FileLock lock(storage::folder_lock(folder.locks()), patience_with_others);
    if (!std::filesystem::exists(folder.plan()) ||
        storage::compare_plan(storage::read_file(folder.plan()), plan) == storage::PlanMatch::same)
        return;
    storage::require_no_run(folder.locks());
    std::filesystem::remove(folder.plan());
}

void remove_left_over(const OutputFolder& folder, storage::CaseClaims& claims,
                      storage::CaseIndex& index) {
    namespace fs = std::filesystem;
    std::error_code ignored; // the folder does not exist yet, or another run has removed the file
    storage::remove_ended_runs(folder.locks());
    for (const std::string& run : folder.recorded_runs())
        if (!fs::exists(folder.locks() / (run + ".run"))) fs::remove(folder.progress(run), ignored);
    for (const auto& entry : fs::directory_iterator(folder.root / "checkpoints", ignored)) {
        const std::string name = entry.path().filename().string();
        if (index.is_complete(name.substr(0, name.find('.')))) fs::remove(entry.path(), ignored);
    }
    for (const auto& place :
         {folder.root, folder.cases(), folder.tables(), folder.failure("").parent_path()})
        for (const auto& entry : fs::directory_iterator(place, ignored))
            if (entry.path().filename().string().find(".part") != std::string::npos)
                remove_part(folder, entry.path(), claims);
    for (const auto& entry : fs::directory_iterator(folder.locks(), ignored))
        if (const std::string id = entry.path().stem().string();
            entry.path().extension() == ".case" && index.is_complete(id) &&
            claims.claim(id) != storage::CaseClaims::Answer::refused)
            claims.release(id);
}

std::vector<SetAside> set_damaged_aside(const OutputFolder& folder, const Plan& plan,
                                        const std::vector<std::size_t>& work,
                                        storage::CaseClaims& claims, storage::CaseIndex& index) {
    std::vector<SetAside> moved;
    for (const std::size_t number : work) {
        const std::string& id = plan.cases[number].id;
        const storage::CaseDigest* digest = index.find(id);
        if (!digest || !digest->is_lost || claims.claim(id) == storage::CaseClaims::Answer::refused)
            continue;
        const std::filesystem::path place = folder.damaged_file(id);
        storage::make_directory(place.parent_path());
        std::error_code error;
        std::filesystem::rename(folder.case_file(id), place, error);
        claims.release(id);
        if (!error)
            moved.push_back({id, digest->damage, place});
        else if (error != std::errc::no_such_file_or_directory) // another run has
            throw UsageError(fmt::format("cannot move the damaged case file {} to {}: {}",
                                         folder.case_file(id).string(), place.string(),
                                         error.message()),
                             ExitCode::environment);
    }
    return moved;
}

} // namespace shearwake::schedule
