// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"

#include "app/python_script.hpp"
#include "app/reduce_folder.hpp"
#include "base/json_document.hpp"
#include "parallel/agree.hpp"
#include "schedule/output_folder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace shearwake::app {
namespace {

/// The sentence that the script prints in the line "result: ...".
std::string result_in(const std::string& output) {
    const std::string start = "result: ";
    if (!output.starts_with(start)) return "";
    return output.substr(start.size(), output.find('\n') - start.size());
}

void print_json(const schedule::OutputFolder& folder, const reduce::ReducedTables& tables,
                const std::string& result) {
    fmt::print("{}", json_document("report", {{"folder", folder.root.string()},
                                              {"page", (folder.report() / "index.html").string()},
                                              {"result", result},
                                              {"cases", tables.rows},
                                              {"complete", tables.whole},
                                              {"not_valid", tables.not_valid},
                                              {"damaged", tables.damaged}}));
}

} // namespace

ExitCode report_command(const ReportArguments& arguments, const Comm& world) {
    ExitCode code = ExitCode::done; // of rank 0; the program exits with the largest of all ranks
    on_root(world, [&] {
        const schedule::OutputFolder folder = schedule::folder_of_results(arguments.folder);
        // So that the table is up to date.
        const reduce::ReducedTables tables = reduce_folder(folder, reduce::ErrorColumns::kept);
        std::vector<std::string> words = {arguments.folder.string()};
        if (!arguments.only.empty())
            words.push_back(fmt::format("--only={}", fmt::join(arguments.only, ",")));
        Captured output{.stream = Stream::output};
        const int status = run_python_script("report/report.py", words, figure_packages,
                                             arguments.json ? &output : nullptr);
        if (status == static_cast<int>(ExitCode::usage))
            throw UsageError("no report was written", ExitCode::usage);
        if (status == static_cast<int>(ExitCode::some_cases_failed))
            code = ExitCode::some_cases_failed;
        else if (status != 0)
            throw UsageError(fmt::format("the report failed (exit {})", status),
                             ExitCode::environment);
        if (arguments.json) print_json(folder, tables, result_in(output.text));
    });
    return code;
}

} // namespace shearwake::app
