// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.hpp"

#include "base/error.hpp"
#include "engines/engine.hpp"
#include "parallel/agree.hpp"
#include "schedule/cost/calibration.hpp"

#include <filesystem>
#include <fmt/format.h>

namespace shearwake::bench {

ExitCode bench_machine(const Comm& world, Output& out) {
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
    out.print("{}\n", machine.measured);
    for (const auto& [kind, rate_s] : machine.rates) {
        out.add(kind, rate_s, "s per unit");
        out.print("  {:<32} {:10.3g} s per unit\n", kind, rate_s);
    }
    out.add("all-to-all, per partner", machine.message_s, "s");
    out.add("all-to-all, per rank", machine.transposed_B_s, "B/s");
    out.add("files of a case", machine.file_s, "s");
    out.add("writing", machine.written_B_s, "B/s");
    out.print("  all-to-all         {:10.2g} s per partner, {:.2g} GB/s per rank{}\n",
              machine.message_s, machine.transposed_B_s / 1e9,
              world.size() == 1 ? " (default values, since there is only one rank)" : "");
    out.print("  files of a case    {:10.4f} s in this folder, in addition to writing\n",
              machine.file_s);
    out.print("  writing            {:10.2g} GB/s in this folder\n", machine.written_B_s / 1e9);
    if (is_kept)
        out.print("saved for plan and run: {}\n", file->string());
    else
        out.print("not saved: SHEARWAKE_CACHE is off, or there is no writable cache folder\n");
    return ExitCode::done;
}

} // namespace shearwake::bench
