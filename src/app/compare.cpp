// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"

#include "app/python_script.hpp"
#include "app/reduce_folder.hpp"
#include "parallel/agree.hpp"

#include <fmt/format.h>

namespace shearwake::app {

ExitCode compare_command(const CompareArguments& arguments, const Comm& world) {
    on_root(world, [&] {
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
        const int status = run_python_script("report/compare.py", words);
        if (status == static_cast<int>(ExitCode::usage))
            throw UsageError("the arguments cannot be compared");
        if (status != 0)
            throw UsageError(fmt::format("the comparison failed (exit {})", status),
                             ExitCode::environment);
    });
    return ExitCode::done;
}

} // namespace shearwake::app
