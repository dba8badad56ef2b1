#include "reduce/diff.hpp"

#include "io/files.hpp"
#include "parallel/agree.hpp"
#include "sweep/commands.hpp"

#include <fmt/format.h>

namespace shearwake {

ExitCode diff_command(const DiffArguments& arguments, const Comm& world) {
    bool equal = true;
    on_root(world, [&] {
        Tolerances tolerances;
        if (!arguments.tolerance_file.empty())
            tolerances = read_tolerances(read_file(arguments.tolerance_file),
                                         arguments.tolerance_file.string());
        for (const std::string& text : arguments.tolerances)
            add_tolerance(tolerances, text);
        const auto now = table_in(arguments.now);
        const auto reference = table_in(arguments.reference);
        const Differences found =
            compare(read_csv(read_file(now), now.string()),
                    read_csv(read_file(reference), reference.string()), tolerances);
        equal = found.none();
        if (!arguments.json.empty()) write_file(arguments.json, json_text(found));
        fmt::print("{} against {}\n{}", now.string(), reference.string(), words(found));
    });
    // Rank 0 alone has looked; the largest code of all ranks is the program's.
    return equal ? ExitCode::done : ExitCode::differs_from_baseline;
}

} // namespace shearwake
