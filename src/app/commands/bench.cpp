// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"
#include "bench/bench.hpp"

namespace shearwake::app {

void add_bench(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<bench::BenchArguments>(
        app, action, "bench", "measure the speed of an engine and that of its FFTs alone",
        bench::bench_command);
    command.add_option("NAME", arguments.engine, "engine: layered (default), spectral or pstd")
        ->check(one_of({"layered", "spectral", "pstd"}));
    add_value(command, "--grid", arguments.grid, "NXxNYxNZ",
              "points and levels of spectral (default 256x192x25), points of pstd")
        ->delimiter('x')
        ->expected(3)
        ->check(CLI::Range(8, 10000));
    command.add_option("--device", arguments.device, "of pstd: cpu (default) or gpu")
        ->check(one_of({"cpu", "gpu"}));
    add_value(command, "-g", arguments.gpu, "N", "number of the GPU, from 0")
        ->check(CLI::Range(0, 1000));
    add_json(command, arguments.json);
}

} // namespace shearwake::app
