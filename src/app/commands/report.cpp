// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "app/common/command.hpp"
#include "studies/tables.hpp"

namespace shearwake::app {
namespace {

std::vector<std::string> reduce_first(const std::vector<std::string>& arguments) {
    studies::reduce_folder(schedule::folder_of_results(arguments.front()),
                           reduce::ErrorColumns::as_before);
    return {};
}

constexpr PythonCommand report{.module = "shearwake.report",
                               .rejection = "no report was written",
                               .failure = "the report failed",
                               .prepare = reduce_first};

} // namespace

void add_report(CLI::App& app, Action& action) {
    CLI::App& command =
        add_python_command(app, action, "report", "draw figures and write one HTML page", report);
    pass_option(command, "DIR", "output folder of a run")->required();
    pass_option(command, "--only",
                "where not all cases can be drawn, draw these, by id, and their references",
                "ID[,ID]")
        ->take_all();
    pass_flag(command, "--json",
              "print a JSON document instead of text (docs/reference/json-output.md)");
}

ExitCode draw_report(const std::filesystem::path& folder, const Comm& world) {
    return execute(report, {folder.string()}, world);
}

void add_movie(CLI::App& app, Action& action) {
    CLI::App& command = add_python_command(app, action, "movie",
                                           "write a movie of the surface of a case (MP4, GIF)",
                                           {.module = "shearwake.report.movie",
                                            .rejection = "the movie was not written",
                                            .failure = "the movie was not written"});
    pass_option(command, "CASE", "case file with several surfaces")->required();
    pass_option(command, "--out",
                "path of the movies without extension (default: that of the case file)", "NAME");
    pass_option(command, "--slow-down",
                "how many times slower than the motion (default: the run takes about 6 s)", "N")
        ->check(CLI::Range(1e-3, 1e9));
    pass_option(command, "--width", "width of the MP4 in pixels (default 960)", "N")
        ->check(CLI::Range(160, 3840));
}

void add_export(CLI::App& app, Action& action) {
    CLI::App& command = add_python_command(app, action, "export",
                                           "write a load for a device, or the scan of a vibrometer",
                                           {.module = "shearwake.device",
                                            .rejection = "the case cannot be exported",
                                            .failure = "the export failed"});
    pass_option(command, "JOB|CASE", "case file (HDF5), or with --to a job (TOML)")->required();
    pass_option(command, "--to", "write the load for a device or in a format of devices")
        ->check(one_of({"csv", "autd3", "ultraleap", "hjif", "wav", "stl", "phases"}));
    pass_option(command, "--rate", "with --to: samples per second (default: the device's)", "HZ")
        ->check(CLI::Range(1.0, 1e6));
    pass_option(command, "--distance-mm", "with --to: distance of the skin from the device", "MM");
    pass_option(command, "-S", "with --to: override a key of the job", "KEY=VALUE")->take_all();
    pass_flag(command, "--no-effect", "with --to: do not compute the effect of the device");
    pass_option(command, "--format",
                "of the scan: uff (Universal File Format, type 58; default), csv, or mat (HDF5 for "
                "MATLAB and Octave)")
        ->check(one_of({"uff", "csv", "mat"}));
    pass_flag(command, "--binary", "with uff: binary instead of ASCII data");
    pass_option(command, "--out",
                "file (default: the id of the case with the extension of the format)", "FILE");
}

} // namespace shearwake::app
