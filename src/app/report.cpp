// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"

#include "app/python_script.hpp"
#include "app/reduce_folder.hpp"
#include "parallel/agree.hpp"
#include "schedule/output_folder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace shearwake::app {

ExitCode report_command(const ReportArguments& arguments, const Comm& world) {
    ExitCode code = ExitCode::done; // of rank 0; the program exits with the largest of all ranks
    on_root(world, [&] {
        const schedule::OutputFolder folder = schedule::folder_of_results(arguments.folder);
        reduce_folder(folder, reduce::ErrorColumns::kept); // so that the table is up to date
        std::vector<std::string> words = {arguments.folder.string()};
        if (!arguments.only.empty())
            words.push_back(fmt::format("--only={}", fmt::join(arguments.only, ",")));
        const int status = run_python_script("report/report.py", words);
        if (status == static_cast<int>(ExitCode::usage))
            throw UsageError("no report was written", ExitCode::usage);
        if (status == static_cast<int>(ExitCode::some_cases_failed))
            code = ExitCode::some_cases_failed;
        else if (status != 0)
            throw UsageError(fmt::format("the report failed (exit {})", status),
                             ExitCode::environment);
    });
    return code;
}

} // namespace shearwake::app
