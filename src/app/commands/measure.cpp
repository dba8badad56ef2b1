// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/laboratory.hpp"

#include "app/commands/commands.hpp"
#include "parallel/agree.hpp"
#include "studies/tables.hpp"

#include <cmath>
#include <fmt/format.h>

namespace shearwake::app {
namespace {

struct MeasureArguments : laboratory::MeasureArguments {
    bool draws_report = true;
};

/// Writes and prints the table.
void print_measurement(const laboratory::Measurement& measured, reduce::ErrorColumns columns) {
    const schedule::OutputFolder& folder = measured.folder;
    const reduce::ReducedTables written = studies::reduce_folder(folder, columns);
    for (const std::string& note : measured.notes)
        fmt::print("{}\n", note);
    const reduce::Table table = studies::table_of(folder);
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
        const auto* value = std::get_if<double>(&table.rows.front()[i]);
        if (!value || std::isnan(*value) || table.columns[i] == "wall_s") continue;
        const auto error = measured.errors.find(table.columns[i]);
        const bool is_known = error != measured.errors.end() && !std::isnan(error->second);
        fmt::print("{} = {:.6g}{}\n", table.columns[i], *value,
                   is_known ? fmt::format(" +- {:.2g}", error->second) : "");
    }
    if (!measured.warning.empty()) fmt::print(stderr, "{}\n", measured.warning);
    fmt::print("case: {}\ntable: {}\n", folder.case_file(measured.id).string(),
               written.csv.string());
}

ExitCode measure_command(const MeasureArguments& arguments, const Comm& world) {
    const laboratory::Measurement measured = laboratory::measure(arguments, world);
    on_root(world, [&] {
        print_measurement(measured, arguments.repetitions > 1 ? reduce::ErrorColumns::added
                                                              : reduce::ErrorColumns::omitted);
    });
    return arguments.draws_report ? draw_report(measured.folder.root, world) : ExitCode::done;
}

} // namespace

void add_measure(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<MeasureArguments>(
        app, action, "measure",
        "compute the table and the figures of a measured scan of the surface", measure_command);
    command.add_option("DATA", arguments.data, scan_texts::data)->required();
    add_value(command, "--options", arguments.job, "JOB",
              "job with the load that was played, the grid, the times, and [vibrometer]")
        ->required();
    add_overrides(command, arguments.overrides);
    add_value(command, "--least-quality", arguments.least_quality, "Q", scan_texts::least_quality)
        ->check(CLI::Range(0.0, 1.0));
    command.add_flag("--outwards", arguments.outwards, scan_texts::outwards);
    add_value(command, "--out", arguments.out, "DIR", scan_texts::out);
    add_value(command, "--fit", arguments.fit, "FILE",
              "fit.json of shearwake fit, whose estimates (alignment, material) replace the "
              "values of the job");
    add_value(command, "--high-pass-Hz", arguments.high_pass_Hz, "F",
              "high-pass before the integration to displacement (default 0: none)")
        ->check(CLI::Range(0.0, 1e6));
    command
        .add_option("--gaps", arguments.gaps,
                    "points without a signal: interpolate (default), or mask: at rest")
        ->check(one_of({"interpolate", "mask"}));
    add_value(command, "--repetitions", arguments.repetitions, "N",
              "repetitions with added noise and left-out points, from which the "
              "uncertainty follows (default 8)")
        ->check(CLI::Range(0, 1000));
    command.add_flag_callback(
        "--no-report", [&draws = arguments.draws_report] { draws = false; }, "draw no figures");
}

} // namespace shearwake::app
