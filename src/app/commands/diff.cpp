// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "base/text.hpp"
#include "parallel/agree.hpp"
#include "reduce/diff.hpp"
#include "schedule/run/output_folder.hpp"
#include "storage/files.hpp"

#include <fmt/format.h>

namespace shearwake::app {
namespace {

struct DiffArguments {
    std::filesystem::path compared, reference; // output folders, or tables (CSV)
    std::vector<std::string> tolerances;       // COLUMN=RELATIVE
    std::filesystem::path tolerance_file;      // TOML; empty: none
    bool json = false;
};

constexpr std::uintmax_t largest_table_B = 100'000'000;

std::filesystem::path table_of(const std::filesystem::path& path) {
    return reduce::table_in(storage::is_csv(path) ? path : schedule::folder_of_results(path).root);
}

ExitCode diff_command(const DiffArguments& arguments, const Comm& world) {
    bool equal = true;
    on_root(world, [&] {
        reduce::Tolerances tolerances;
        if (!arguments.tolerance_file.empty())
            tolerances = reduce::read_tolerances(
                storage::read_file(arguments.tolerance_file, storage::largest_user_text_B),
                arguments.tolerance_file.string());
        for (const std::string& text : arguments.tolerances)
            reduce::add_tolerance(tolerances, text);
        const auto compared = table_of(arguments.compared);
        const auto reference = table_of(arguments.reference);
        const auto read = [](const std::filesystem::path& table) {
            return reduce::read_csv(storage::read_file(table, largest_table_B), table.string());
        };
        const reduce::Differences found =
            reduce::compare(read(compared), read(reference), tolerances);
        equal = found.none();
        if (arguments.json)
            fmt::print("{}", reduce::json_text(found, compared, reference));
        else
            fmt::print("{}", printable(fmt::format("{} compared with {}\n{}", compared.string(),
                                                   reference.string(), reduce::words(found))));
    });
    // Only rank 0 compares. The program exits with the largest code of all ranks.
    return equal ? ExitCode::done : ExitCode::differs_from_baseline;
}

} // namespace

void add_diff(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<DiffArguments>(
        app, action, "diff", "compare two tables, with tolerances; exit 5 if they differ",
        diff_command);
    command.add_option("DIR", arguments.compared, "output folder, or table (CSV)")->required();
    command
        .add_option("BASELINE", arguments.reference,
                    "reference to compare with: output folder, or table (CSV)")
        ->required();
    add_value(command, "--tolerance", arguments.tolerances, "COLUMN=REL",
              "relative tolerance of a column (*: of all columns that are not named)")
        ->allow_extra_args(false)
        ->take_all();
    add_value(command, "--tolerances", arguments.tolerance_file, "FILE",
              "file with tolerances (TOML)");
    add_json(command, arguments.json);
}

} // namespace shearwake::app
