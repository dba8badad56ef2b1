// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.hpp"

#include "base/error.hpp"
#include "cost/calibration.hpp"
#include "engines/engine.hpp"
#include "parallel/agree.hpp"

#include <filesystem>
#include <fmt/format.h>

namespace shearwake::bench {

ExitCode bench_machine(const Comm& world) {
    const cost::Machine machine =
        cost::calibrated({}, cost::every_kind(), world,
                         {[](const std::string& text) { fmt::print(stderr, "{}\n", text); },
                          std::filesystem::path(".")});
    const auto file = cost::machine_file(world.size());
    bool is_kept = false;
    if (world.is_root() && file && !machine.measured.empty())
        is_kept = cost::keep_machine(machine, *file);
    if (!world.is_root()) return ExitCode::done;
    if (machine.measured.empty()) return ExitCode::environment;
    fmt::print("{}\n", machine.measured);
    for (const auto& [kind, rate_s] : machine.rates)
        fmt::print("  {:<32} {:10.3g} s per unit\n", kind, rate_s);
    fmt::print("  all-to-all         {:10.2g} s per partner, {:.2g} GB/s per rank{}\n",
               machine.message_s, machine.transposed_B_s / 1e9,
               world.size() == 1 ? " (default values, since there is only one rank)" : "");
    fmt::print("  files of a case    {:10.4f} s in this folder, in addition to writing\n",
               machine.file_s);
    fmt::print("  writing            {:10.2g} GB/s in this folder\n", machine.written_B_s / 1e9);
    if (is_kept)
        fmt::print("saved for plan and run: {}\n", file->string());
    else
        fmt::print("not saved: SHEARWAKE_CACHE is off, or there is no writable cache folder\n");
    return ExitCode::done;
}

} // namespace shearwake::bench
