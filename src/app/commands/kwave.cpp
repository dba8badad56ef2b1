// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "kwave/run.hpp"
#include "pipeline/provenance.hpp"

#include <initializer_list>
#include <set>
#include <string>
#include <utility>

namespace shearwake::app {

namespace {

/// The options that name what is recorded.
void add_records(CLI::App& command, std::set<std::string>& records) {
    for (const auto& [name, text] : std::initializer_list<std::pair<const char*, const char*>>{
             {"-p,--p_raw", "pressure at the sensor in every step (default)"},
             {"--p_max", "maximum of the pressure at the sensor"},
             {"--p_min", "minimum of the pressure at the sensor"},
             {"--p_rms", "root mean square of the pressure at the sensor"},
             {"--p_max_all", "maximum of the pressure at every node, also of the absorbing layer"},
             {"--p_min_all", "minimum of the pressure at every node"},
             {"--p_final", "pressure at every node after the last step"},
             {"-u,--u_raw", "velocities ux, uy, uz at their staggered points near the sensor"},
             {"--u_non_staggered_raw", "velocities at the nodes of the sensor"},
             {"--u_split_field_raw",
              "compressional and shear parts of these velocities (ux_split_p, ux_split_s, ...)"},
             {"--I_raw",
              "intensity Ix, Iy, Iz in every step: the pressure times the velocity at the node, "
              "moved to the same time"},
             {"--I_avg", "mean intensity"},
             {"--u_max", "maximum of each velocity at the sensor"},
             {"--u_min", "minimum of each velocity at the sensor"},
             {"--u_rms", "root mean square of each velocity at the sensor"},
             {"--u_max_all", "maximum of each velocity at every point of the grid"},
             {"--u_min_all", "minimum of each velocity at every point"},
             {"--u_final", "each velocity at every point after the last step"}}) {
        const std::string names = name;
        std::string record = names.substr(names.find("--") + 2);
        if (record.ends_with("_raw")) record.resize(record.size() - 4);
        command.add_flag_callback(
            names, [&records, record] { records.insert(record); }, text);
    }
}

} // namespace

void add_kwave(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<kwave::Arguments>(
        app, action, "kwave",
        "run the elastic input file of k-Wave (pstdElastic3D with 'SaveToDisk') and write the "
        "output file of its compiled programs; exit code 1 for every error, as they have",
        kwave::run);
    add_value(command, "-i", arguments.input, "FILE",
              "input file of pstdElastic3D or of scripts/import-kwave")
        ->required();
    add_value(command, "-o", arguments.output, "FILE",
              "output file; an existing one is removed at the start")
        ->required();
    add_records(command, arguments.records);
    add_value(command, "-s", arguments.first_step, "STEP",
              "first step that is recorded (default 1)")
        ->check(CLI::Range(1L, 1L << 30));
    command.add_flag("--copy_sensor_mask", arguments.copies_sensor_mask,
                     "store the sensor mask in the output file");
    command
        .add_option("--precision", arguments.precision,
                    "precision of the computation: double (default) or single")
        ->check(one_of({"double", "single"}));
    command
        .add_option("--output_precision", arguments.output_precision,
                    "precision of the output file: single (default, as in k-Wave) or double")
        ->check(one_of({"single", "double"}));
    add_value(command, "-c", arguments.gzip_level, "LEVEL",
              "gzip level of the output file (default 0)")
        ->check(CLI::Range(0, 9));
    add_value(command, "--benchmark", arguments.steps, "N",
              "run only this number of steps, which is the Nt of the output")
        ->check(CLI::Range(1L, 1L << 30));
    add_value(command, "--checkpoint_file", arguments.checkpoint, "FILE",
              "end at a checkpoint, which the same command resumes; removed at the end");
    add_value(command, "--checkpoint_interval", arguments.checkpoint_interval_s, "S",
              "seconds until the checkpoint")
        ->check(CLI::Range(1.0, 1e9));
    add_value(command, "--checkpoint_timesteps", arguments.checkpoint_steps, "N",
              "steps until the checkpoint")
        ->check(CLI::Range(1L, 1L << 30));
    add_value(command, "-r", arguments.progress_percent, "PERCENT",
              "interval of progress lines in percent (default 5)")
        ->check(CLI::Range(1, 100));
    add_value(command, "--verbose", arguments.verbose, "LEVEL",
              "what is printed: 0 basic (default), 1 records, 2 memory")
        ->check(CLI::Range(0, 2));
    add_value(command, "-t", arguments.threads, "N",
              "ranks that kspaceFirstOrder-elastic starts; otherwise ignored with a note")
        ->check(CLI::Range(1, 1000000));
    command.set_version_flag("--version", pipeline::version_text());
    command
        .add_option("--device", arguments.device,
                    "what computes: cpu (default), or gpu, a GPU with OpenCL")
        ->check(one_of({"cpu", "gpu"}));
    add_value(command, "-g", arguments.gpu, "N",
              "number of the GPU, from 0; otherwise ignored with a note")
        ->check(CLI::Range(0, 1000));
}

} // namespace shearwake::app
