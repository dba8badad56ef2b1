// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "bench/bench.hpp"

namespace shearwake::app {

void add_bench(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<bench::BenchArguments>(
        app, action, "bench",
        "measure this machine's speed and compare it with the lower bound set by FFTs and "
        "memory bandwidth",
        bench::bench_command);
    command
        .add_option("NAME", arguments.engine,
                    "layered (default), spectral, pstd or neural: the speed of an engine or of the "
                    "receptors; files: writing and verifying 1 GB of frames")
        ->check(one_of({"layered", "spectral", "pstd", "neural", "files"}));
    command
        .add_option(
            "--grid", arguments.grid,
            "spectral: points and levels (default 256x192x25); pstd: points (default 128x96x32 and "
            "128x128x128)")
        ->type_name("NXxNYxNZ");
    command
        .add_option("--steps", arguments.steps,
                    "spectral, pstd: number of timed steps (default 20)")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000));
    command
        .add_option("--contrast", arguments.contrast,
                    "spectral: stiffness of the body relative to the layer (default 4; 1: no body)")
        ->type_name("C")
        ->check(CLI::Range(1.0, 1e6));
    command.add_flag("--rigid", arguments.rigid,
                     "spectral: a rigid cylinder of 5 mm radius instead of the body");
    command.add_flag("--lump", arguments.lump,
                     "spectral: a rigid ellipsoid of 12 x 10 x 6 mm instead of the body");
    command
        .add_option("--sponge", arguments.sponge_mm,
                    "spectral: absorbing margin, mm (default 0: none)")
        ->type_name("MM")
        ->check(CLI::Range(0.0, 60.0));
    add_json(command, arguments.json);
}

} // namespace shearwake::app
