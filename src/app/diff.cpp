// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/diff.hpp"

#include "app/commands.hpp"
#include "parallel/agree.hpp"
#include "schedule/run/output_folder.hpp"
#include "storage/files.hpp"

#include <fmt/format.h>

namespace shearwake::app {
namespace {

std::filesystem::path table_of(const std::filesystem::path& path) {
    return reduce::table_in(path.extension() == ".csv" ? path
                                                       : schedule::folder_of_results(path).root);
}

} // namespace

ExitCode diff_command(const DiffArguments& arguments, const Comm& world) {
    bool equal = true;
    on_root(world, [&] {
        reduce::Tolerances tolerances;
        if (!arguments.tolerance_file.empty())
            tolerances = reduce::read_tolerances(storage::read_file(arguments.tolerance_file),
                                                 arguments.tolerance_file.string());
        for (const std::string& text : arguments.tolerances)
            reduce::add_tolerance(tolerances, text);
        const auto now = table_of(arguments.now);
        const auto reference = table_of(arguments.reference);
        const reduce::Differences found = reduce::compare(
            reduce::read_csv(storage::read_file(now), now.string()),
            reduce::read_csv(storage::read_file(reference), reference.string()), tolerances);
        equal = found.none();
        if (arguments.json)
            fmt::print("{}", reduce::json_text(found, now, reference));
        else
            fmt::print("{} compared with {}\n{}", now.string(), reference.string(),
                       reduce::words(found));
    });
    // Only rank 0 compares. The program exits with the largest code of all ranks.
    return equal ? ExitCode::done : ExitCode::differs_from_baseline;
}

} // namespace shearwake::app
