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
    command.add_option("NAME", arguments.engine, "engine: layered (default), spectral or pstd")
        ->check(one_of({"layered", "spectral", "pstd"}));
    add_value(
        command, "--grid", arguments.grid, "NXxNYxNZ",
        "spectral: points and levels (default 256x192x25); pstd: points (default 128x96x32 and "
        "128x128x128)");
    add_value(command, "--steps", arguments.steps, "N",
              "spectral, pstd: number of timed steps (default 20)")
        ->check(CLI::Range(1, 1000000));
    add_value(command, "--contrast", arguments.contrast, "C",
              "spectral: stiffness of the body relative to the layer (default 4; 1: no body)")
        ->check(CLI::Range(1.0, 1e6));
    command.add_flag("--rigid", arguments.rigid,
                     "spectral: a rigid cylinder of 5 mm radius instead of the body");
    add_value(command, "--sponge", arguments.sponge_mm, "MM",
              "spectral: absorbing margin, mm (default 0: none)")
        ->check(CLI::Range(0.0, 60.0));
    add_json(command, arguments.json);
}

} // namespace shearwake::app
