// SPDX-License-Identifier: BSD-3-Clause
#include "app/laboratory_commands.hpp"

#include "app/commands.hpp"
#include "app/python_command.hpp"

namespace shearwake::app {
namespace {

void add_scan(CLI::App* command, schedule::JobArguments& job, std::filesystem::path& out,
              double& least_quality) {
    command->add_option("-S", job.overrides, "override a key of the job: -S load.peak_Pa=200")
        ->type_name("KEY=VALUE")
        ->take_all();
    command
        ->add_option("--least-quality", least_quality,
                     "ignore points below this quality, 0 to 1 (default 0: only those without a "
                     "signal)")
        ->type_name("Q")
        ->check(CLI::Range(0.0, 1.0));
    command->add_option("--out", out, "output folder (default: named after the job, in out)")
        ->type_name("DIR");
}

void add_measure(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<MeasureArguments>();
    CLI::App* command = app.add_subcommand(
        "measure", "compute the table and the figures of a measured scan of the surface");
    command
        ->add_option("DATA", arguments->data,
                     "scan: UFF 58 (ASCII or binary), MATLAB (5 or 7.3), CSV, HDF5 or a case file")
        ->required();
    command
        ->add_option("--options", arguments->job,
                     "job with the load that was played, the grid, the times, and [vibrometer]")
        ->type_name("JOB")
        ->required();
    add_scan(command, *arguments, arguments->out, arguments->least_quality);
    command
        ->add_option("--fit", arguments->fit,
                     "fit.json of shearwake fit, whose estimates (alignment, material) replace the "
                     "values of the job")
        ->type_name("FILE");
    command
        ->add_option("--high-pass-Hz", arguments->high_pass_Hz,
                     "high-pass before the integration to displacement (default 0: none)")
        ->type_name("F")
        ->check(CLI::Range(0.0, 1e6));
    command
        ->add_option("--gaps", arguments->gaps,
                     "points without a signal: interpolate (default), or mask: at rest")
        ->check(one_of({"interpolate", "mask"}));
    command
        ->add_option("--repetitions", arguments->repetitions,
                     "repetitions with added noise and left-out points, from which the "
                     "uncertainty follows (default 8)")
        ->type_name("N")
        ->check(CLI::Range(0, 1000));
    command->add_flag_callback(
        "--no-report", [=] { arguments->draws = false; }, "draw no figures");
    command->callback([=, &action] {
        action = [=](const Comm& world) { return measure_command(*arguments, world); };
    });
}

void add_fit(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<FitArguments>();
    CLI::App* command =
        app.add_subcommand("fit", "estimate the keys of [uncertain] of a job from a measured scan");
    command
        ->add_option("JOB", arguments->job,
                     "job file (TOML); the distributions of [uncertain] are bounds and priors")
        ->required();
    command
        ->add_option("--data", arguments->data,
                     "scan: UFF 58 (ASCII or binary), MATLAB (5 or 7.3), CSV, HDF5 or a case file")
        ->type_name("DATA")
        ->required();
    add_scan(command, *arguments, arguments->out, arguments->least_quality);
    command->callback([=, &action] {
        action = [=](const Comm& world) { return fit_command(*arguments, world); };
    });
}

} // namespace

void add_laboratory_commands(CLI::App& app, Action& action) {
    add_python_command(app, action, "export");
    add_measure(app, action);
    add_fit(app, action);
}

} // namespace shearwake::app
