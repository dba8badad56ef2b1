#include "reduce/reduce.hpp"

#include "parallel/agree.hpp"
#include "sweep/commands.hpp"
#include "sweep/output_folder.hpp"

#include <fmt/format.h>

namespace shearwake {

ExitCode reduce_command(const std::filesystem::path& path, const Comm& world) {
    const OutputFolder folder{path};
    on_root(world, [&] {
        const ReducedTables written =
            reduce({.folder = folder.root, .plan = folder.plan(), .tables = folder.tables()});
        fmt::print("{} cases, {} of them whole, {} failed or missing\n", written.rows,
                   written.whole, written.rows - written.whole);
        if (written.programs.size() > 1)
            fmt::print("warning: the cases are of {} versions of the program: {}\n",
                       written.programs.size() == 2 ? "two"
                                                    : std::to_string(written.programs.size()),
                       fmt::join(written.programs, ", "));
        fmt::print("table: {}\n       {}\nnext: shearwake report {}\n", written.csv.string(),
                   written.markdown.string(), path.string());
    });
    return ExitCode::done;
}

} // namespace shearwake
