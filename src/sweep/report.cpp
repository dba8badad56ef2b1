#include "sweep/commands.hpp"

#include "io/plan_file.hpp"
#include "parallel/agree.hpp"
#include "sweep/output_folder.hpp"
#include "sweep/python_script.hpp"

#include <fmt/format.h>

namespace shearwake {

ExitCode report_command(const std::filesystem::path& path, const Comm& world) {
    ExitCode code = ExitCode::done;
    on_root(world, [&] {
        const OutputFolder folder{path};
        read_plan(folder.plan()); // a clear message when this is no output folder
        const int status = run_python_script("report.py", {path.string()});
        if (status != 0)
            throw UsageError(fmt::format("the report failed (exit {})", status),
                             ExitCode::environment);
    });
    return code;
}

} // namespace shearwake
