// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "app/common/python_command.hpp"

namespace shearwake::app {

void add_export(CLI::App& app, Action& action) {
    CLI::App& command = add_python_command(
        app, action, "export", "write the scan of the vibrometer of a case for other programs",
        {.module = "shearwake.laboratory.export_scan",
         .rejection = "the scan cannot be exported",
         .failure = "the export failed"});
    pass_option(command, "CASE", "case file (HDF5)")->required();
    pass_option(command, "--format",
                "format: uff (Universal File Format, type 58; default), csv, or mat (HDF5 for "
                "MATLAB and Octave)")
        ->check(one_of({"uff", "csv", "mat"}));
    pass_flag(command, "--binary", "with uff: binary instead of ASCII data");
    pass_option(command, "--out",
                "file (default: the id of the case with the extension of the format)");
}

} // namespace shearwake::app
