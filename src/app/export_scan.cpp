// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands.hpp"

#include "app/python_script.hpp"
#include "parallel/agree.hpp"

#include <fmt/format.h>

namespace shearwake::app {

ExitCode export_command(const ExportArguments& arguments, const Comm& world) {
    on_root(world, [&] {
        std::string kind = arguments.format, file = arguments.out.string();
        if (arguments.binary && kind != "uff")
            throw UsageError("--binary applies only with --format uff");
        if (arguments.binary) kind = "uffb";
        if (file.empty()) file = arguments.case_file.stem().string() + "." + arguments.format;
        const int status = run_python_script("laboratory/export_scan.py",
                                             {arguments.case_file.string(), kind, file});
        if (status == static_cast<int>(ExitCode::usage))
            throw UsageError("the scan cannot be exported");
        if (status != 0)
            throw UsageError(fmt::format("the export failed (exit {})", status),
                             ExitCode::environment);
    });
    return ExitCode::done;
}

} // namespace shearwake::app
