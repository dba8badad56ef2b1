// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/reduce.hpp"

#include "app/commands.hpp"
#include "app/reduce_folder.hpp"
#include "parallel/agree.hpp"
#include "schedule/output_folder.hpp"

#include <fmt/format.h>

namespace shearwake::app {

ExitCode reduce_command(const ReduceArguments& arguments, const Comm& world) {
    const std::filesystem::path& path = arguments.folder;
    schedule::OutputFolder folder;
    long damaged = 0;
    on_root(world, [&] {
        folder = schedule::folder_of_results(path);
        const reduce::ReducedTables written = reduce_folder(folder, arguments.errors);
        fmt::print("{} case{}: {} complete, {} failed or missing\n", written.rows,
                   written.rows == 1 ? "" : "s", written.whole, written.rows - written.whole);
        if (const std::size_t left = written.rows - written.whole; left > 0 && written.whole > 0)
            fmt::print(stderr,
                       "warning: the table is partial: {} of {} cases ha{} no result, and "
                       "{} empty; shearwake status {} lists the reasons\n",
                       left, written.rows, left == 1 ? "s" : "ve",
                       left == 1 ? "its row is" : "their rows are", path.string());
        if (written.not_valid > 0)
            fmt::print("the readings of {} case{} are not valid: see the column note\n",
                       written.not_valid, written.not_valid == 1 ? "" : "s");
        if (written.programs.size() > 1)
            fmt::print("warning: {} versions of the program computed the cases: {}\n",
                       written.programs.size() == 2 ? "two"
                                                    : std::to_string(written.programs.size()),
                       fmt::join(written.programs, ", "));
        damaged = static_cast<long>(written.damaged.size());
        if (damaged > 0)
            fmt::print(stderr,
                       "error: {} damaged case file{}: {}; the rows of these cases are empty, the "
                       "next run computes them again\n",
                       damaged, damaged == 1 ? "" : "s", fmt::join(written.damaged, ", "));
        if (written.without_checksum > 0)
            fmt::print("note: {} case files were written by an earlier version without checksum: "
                       "damage to them cannot be detected\n",
                       written.without_checksum);
        if (written.whole == 0)
            throw UsageError(fmt::format("no case of {} is complete, so there is nothing to "
                                         "reduce; shearwake status {} lists the reasons",
                                         path.string(), path.string()),
                             ExitCode::some_cases_failed);
        fmt::print("table: {}\n       {}\n", written.csv.string(), written.markdown.string());
        for (const auto& file : {written.statistics, written.sensitivity, written.adaptive})
            if (!file.empty()) fmt::print("       {}\n", file.string());
        fmt::print("next: shearwake report {}\n", path.string());
    });
    return world.broadcast(damaged) > 0 ? ExitCode::some_cases_failed : ExitCode::done;
}

} // namespace shearwake::app
