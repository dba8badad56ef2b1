#include "sweep/output_folder.hpp"

#include "base/error.hpp"
#include "io/files.hpp"
#include "io/journal.hpp"
#include "io/plan_file.hpp"
#include "io/run_lock.hpp"
#include "sweep/case_checkpoints.hpp"
#include "sweep/provenance.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <fmt/format.h>

namespace shearwake {
namespace {

/// What a run makes there, and what its removal in mid-run leaves of it.
bool is_ours(const std::string& name) {
    constexpr std::array names = {"cases",  "job.toml",    "plan.json", "STOP",  "slurm",
                                  "failed", "checkpoints", "locks",     "tables"};
    if (std::ranges::find(names, name) != names.end() || name.ends_with(".part")) return true;
    return (name.starts_with("journal.") || name.starts_with("index.")) && name.ends_with(".jsonl");
}

/// Whether a folder without a plan holds anything else.
bool holds_foreign_files(const OutputFolder& folder) {
    for (const auto& entry : std::filesystem::directory_iterator(folder.root))
        if (!is_ours(entry.path().filename().string())) return true;
    return false;
}

/// What a program that was killed has left of files that are written whole,
/// `<name>.<process>.part`. One that is younger than a minute may be a run's beside this one.
void remove_left_over(const std::filesystem::path& place, RunLock::Sharing beside) {
    namespace fs = std::filesystem;
    std::error_code missing; // a folder that is not there yet, a file that another has removed
    for (const auto& entry : fs::directory_iterator(place, missing)) {
        const fs::path& path = entry.path();
        if (path.extension() != ".part" || path.stem().extension() == ".h5") continue;
        const auto age = fs::file_time_type::clock::now() - fs::last_write_time(path, missing);
        if (beside == RunLock::Sharing::alone || age > std::chrono::minutes(1))
            fs::remove(path, missing);
    }
}

} // namespace

std::filesystem::path OutputFolder::journal(const std::string& part,
                                            const std::string& host) const {
    return root / journal_name(part, host);
}

std::filesystem::path OutputFolder::index(const std::string& part, const std::string& host) const {
    return root / index_name(journal_name(part, host));
}

bool OutputFolder::has_lost_plan() const {
    std::error_code trouble;
    return !std::filesystem::exists(plan(), trouble) && !trouble;
}

void prepare_output(const OutputFolder& folder, const Job& job) {
    namespace fs = std::filesystem;
    const std::string text = plan_text(job.plan);
    if (fs::exists(folder.plan())) {
        if (read_file(folder.plan()) != text)
            throw UsageError(
                fmt::format("{} holds the results of another plan (its plan.json differs "
                            "from this job's); choose another folder with --out, or "
                            "remove that one",
                            folder.root.string()));
    } else if (fs::exists(folder.root) && holds_foreign_files(folder)) {
        throw UsageError(fmt::format("{} is not empty and holds no plan of this program; choose "
                                     "another folder with --out",
                                     folder.root.string()));
    }
    make_directory(folder.cases());
    make_directory(folder.run_lock().parent_path());
    if (!fs::exists(folder.plan())) write_file(folder.job(), job.text);
    // The plan last: a folder without one was never begun.
    if (!fs::exists(folder.plan())) write_file(folder.plan(), text);
}

void clear_half_written(const OutputFolder& folder, const Plan& plan,
                        const std::vector<std::size_t>& work, CaseIndex& index,
                        RunLock::Sharing beside) {
    const CaseClaims claims(folder.claims());
    for (const std::size_t number : work) {
        const std::string& id = plan.cases[number].id;
        const std::filesystem::path part = folder.case_file(id).string() + ".part";
        if (!std::filesystem::exists(part) || !claims.claim(number)) continue;
        if (!has_checkpoint(folder.checkpoints(id), {id, program_git_id()}))
            std::filesystem::remove(part);
        claims.release(number);
    }
    for (const auto& place :
         {folder.root, folder.cases(), folder.tables(), folder.failure("").parent_path()})
        remove_left_over(place, beside);
    if (!std::filesystem::exists(folder.root / "checkpoints")) return;
    for (const PlannedCase& c : plan.cases)
        if (index.is_whole(c.id)) remove_checkpoints(folder.checkpoints(c.id));
}

} // namespace shearwake
