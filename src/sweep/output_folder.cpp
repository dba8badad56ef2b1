#include "sweep/output_folder.hpp"

#include "base/error.hpp"
#include "io/case_file_reader.hpp"
#include "io/files.hpp"
#include "io/plan_file.hpp"
#include "sweep/case_checkpoints.hpp"
#include "sweep/provenance.hpp"

#include <fmt/format.h>

namespace shearwake {
namespace {

/// Whether a folder without a plan holds anything but what a run that is just beginning makes.
bool holds_foreign_files(const OutputFolder& folder) {
    for (const auto& entry : std::filesystem::directory_iterator(folder.root)) {
        const std::filesystem::path& path = entry.path();
        const bool ours = path == folder.cases() || path == folder.job() || path == folder.plan() ||
                          path.extension() == ".part";
        if (!ours) return true;
    }
    return false;
}

} // namespace

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
    if (!fs::exists(folder.plan())) write_file(folder.job(), job.text);
    // The plan last: a folder without one was never begun.
    if (!fs::exists(folder.plan())) write_file(folder.plan(), text);
}

void clear_half_written(const OutputFolder& folder, const Plan& plan,
                        const std::vector<std::string>& ids) {
    for (const std::string& id : ids)
        if (!has_checkpoint(folder.checkpoints(id), {id, program_git_id()}))
            std::filesystem::remove(folder.case_file(id).string() + ".part");
    if (!std::filesystem::exists(folder.root / "checkpoints")) return;
    for (const PlannedCase& c : plan.cases)
        if (is_whole(folder.case_file(c.id), c.id)) remove_checkpoints(folder.checkpoints(c.id));
}

} // namespace shearwake
