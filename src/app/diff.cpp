// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/diff.hpp"

#include "app/commands.hpp"
#include "parallel/agree.hpp"
#include "storage/files.hpp"

#include <fmt/format.h>

namespace shearwake::app {

ExitCode diff_command(const DiffArguments& arguments, const Comm& world) {
    bool equal = true;
    on_root(world, [&] {
        reduce::Tolerances tolerances;
        if (!arguments.tolerance_file.empty())
            tolerances = reduce::read_tolerances(storage::read_file(arguments.tolerance_file),
                                                 arguments.tolerance_file.string());
        for (const std::string& text : arguments.tolerances)
            reduce::add_tolerance(tolerances, text);
        const auto now = reduce::table_in(arguments.now);
        const auto reference = reduce::table_in(arguments.reference);
        const reduce::Differences found = reduce::compare(
            reduce::read_csv(storage::read_file(now), now.string()),
            reduce::read_csv(storage::read_file(reference), reference.string()), tolerances);
        equal = found.none();
        if (!arguments.json.empty()) storage::write_file(arguments.json, reduce::json_text(found));
        fmt::print("{} compared with {}\n{}", now.string(), reference.string(),
                   reduce::words(found));
    });
    // Only rank 0 compares. The program exits with the largest code of all ranks.
    return equal ? ExitCode::done : ExitCode::differs_from_baseline;
}

} // namespace shearwake::app
