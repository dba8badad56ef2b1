// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"

#include "app/python_script.hpp"
#include "app/reduce_folder.hpp"
#include "parallel/agree.hpp"
#include "schedule/output_folder.hpp"

#include <fmt/format.h>

namespace shearwake::app {

namespace {

/// Throws UsageError if the path is neither a case file nor a folder.
void must_be_comparable(const std::filesystem::path& path) {
    if (!std::filesystem::exists(path))
        throw UsageError(fmt::format("{} does not exist: there is no such case file or output "
                                     "folder; run the job first",
                                     path.string()),
                         ExitCode::environment);
    if (path.extension() == ".toml") schedule::folder_of_results(path); // explains a job file
}

/// The error in the messages of the script, without the word "error".
std::string error_in(const std::string& messages) {
    const std::string start = "error: ";
    const auto at = messages.rfind(start);
    if (at == std::string::npos) return "";
    const auto from = at + start.size();
    return messages.substr(from, messages.find('\n', from) - from);
}

} // namespace

ExitCode compare_command(const CompareArguments& arguments, const Comm& world) {
    on_root(world, [&] {
        for (const std::filesystem::path& path : {arguments.first, arguments.second})
            must_be_comparable(path);
        for (const std::filesystem::path& path : {arguments.first, arguments.second})
            if (std::filesystem::is_directory(path))
                reduce_folder({path}, reduce::ErrorColumns::kept); // so that tables are current
        std::vector<std::string> words = {arguments.first.string(), arguments.second.string()};
        if (arguments.json) words.emplace_back("--json");
        if (arguments.all) words.emplace_back("--all");
        if (!arguments.picture.empty()) {
            words.emplace_back("--picture");
            words.push_back(arguments.picture.string());
        }
        Captured messages{.stream = Stream::errors};
        const int status = run_python_script("report/compare.py", words, figure_packages,
                                             arguments.json ? &messages : nullptr);
        const std::string error = error_in(messages.text);
        if (error.empty()) fmt::print(stderr, "{}", messages.text);
        if (status == static_cast<int>(ExitCode::usage))
            throw UsageError(error.empty() ? "the arguments cannot be compared" : error);
        if (status != 0)
            throw UsageError(error.empty() ? fmt::format("the comparison failed (exit {})", status)
                                           : error,
                             ExitCode::environment);
    });
    return ExitCode::done;
}

} // namespace shearwake::app
