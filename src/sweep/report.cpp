#include "sweep/commands.hpp"

#include "io/plan_file.hpp"
#include "parallel/agree.hpp"
#include "sweep/output_folder.hpp"
#include "sweep/python_script.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake {
namespace {

bool holds_cases(const OutputFolder& folder) {
    namespace fs = std::filesystem;
    if (!fs::is_directory(folder.cases())) return false;
    const fs::directory_iterator files(folder.cases());
    return std::any_of(fs::begin(files), fs::end(files),
                       [](const auto& entry) { return entry.path().extension() == ".h5"; });
}

} // namespace

ExitCode report_command(const std::filesystem::path& path, const Comm& world) {
    ExitCode code = ExitCode::done;
    on_root(world, [&] {
        const OutputFolder folder{path};
        // The case files alone will do; else a clear message when this is no output folder.
        if (std::filesystem::exists(folder.plan()) || !holds_cases(folder))
            read_plan(folder.plan());
        const int status = run_python_script("report.py", {path.string()});
        if (status != 0)
            throw UsageError(fmt::format("the report failed (exit {})", status),
                             ExitCode::environment);
    });
    return code;
}

} // namespace shearwake
