#include "sweep/output_folder.hpp"

#include "base/error.hpp"
#include "io/files.hpp"
#include "io/plan_file.hpp"

#include <fmt/format.h>
#include <vector>

namespace shearwake {

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
    } else if (fs::exists(folder.root) && !fs::is_empty(folder.root)) {
        throw UsageError(fmt::format("{} is not empty and holds no plan of this program; choose "
                                     "another folder with --out",
                                     folder.root.string()));
    }
    make_directory(folder.cases());
    if (!fs::exists(folder.job())) write_file(folder.job(), job.text);
    // The plan last: a folder without one was never begun.
    if (!fs::exists(folder.plan())) write_file(folder.plan(), text);
    std::vector<fs::path> stale;
    for (const auto& entry : fs::directory_iterator(folder.cases()))
        if (entry.path().extension() == ".part") stale.push_back(entry.path());
    for (const fs::path& path : stale)
        fs::remove(path);
}

} // namespace shearwake
