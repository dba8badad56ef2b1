// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.hpp"

#include "base/error.hpp"
#include "parallel/agree.hpp"
#include "schedule/job_source.hpp"
#include "schedule/run.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <string>
#include <unistd.h>
#include <vector>

namespace shearwake::bench {
namespace {

namespace fs = std::filesystem;

/// A job with a focus at 7 m/s on a layer of 12 mm.
std::string job(const char* name, double spacing_mm, int duration_ms, const std::string& sweep) {
    return fmt::format(R"(schema = 1

[job]
name = "{0}"

[medium]
base = "rigid"

[[medium.layer]]
thickness_mm = 12.0
density_kg_m3 = 1000.0
c_p_m_s = 1500.0
c_s_m_s = 5.0
viscosity_Pa_s = 0.5

[load]
peak_Pa = 100.0
footprint = {{ shape = "gaussian", fwhm_mm = 8.0 }}

[load.modulation]
kind = "AM-STM"
path = {{ shape = "line", from_mm = [-{2}, 0.0], to_mm = [{2}, 0.0] }}
speed_m_s = 7.0
am_frequency_Hz = 500.0

[domain]
extent_mm = [64.0, 48.0]
spacing_mm = {1}

[time]
duration_ms = {3}
output_interval_us = 100.0

[measure]
at_ms = {3}
settled_after_ms = 0.0

[sweep]
{4})",
                       name, spacing_mm, 3.5 * duration_ms, duration_ms, sweep);
}

std::string tiny_job(int cases) {
    std::vector<double> frequencies_Hz;
    for (int i = 0; i < cases; ++i)
        frequencies_Hz.push_back(500.0 + 1000.0 * i / cases);
    return job("tiny", 2.0, 2,
               fmt::format("\"load.modulation.am_frequency_Hz\" = [{}]\n",
                           fmt::join(frequencies_Hz, ", ")));
}

/// 32 cases of both engines. The longest takes about a hundred times as long as the shortest.
std::string mixed_job() {
    return job("mixed", 1.0, 6, R"("domain.spacing_mm" = [0.75, 1.5]
"solver.engine" = ["layered", "spectral"]
"load.modulation.am_frequency_Hz" = [500, 600, 700, 800, 900, 1000, 1100, 1200]
)");
}

struct Seen {
    double seconds = 0.0;
    storage::RunTimes times;
    std::size_t cases = 0;
};

/// Runs a job with one rank per case in a folder that is removed afterwards.
Seen run_job(const fs::path& folder, const std::string& text, const Comm& world) {
    schedule::RunArguments arguments;
    arguments.job = folder / "job.toml";
    arguments.out = folder / "out";
    arguments.ranks_per_case = 1;
    arguments.quiet = true;
    on_root(world, [&] {
        storage::make_directory(folder);
        storage::write_file(arguments.job, text);
    });
    Seen seen;
    ExitCode code = ExitCode::done;
    seen.seconds = seconds_of(world, [&] { code = schedule::run_sweep(arguments, world); });
    on_root(world, [&] {
        const storage::JournalContents journal = storage::read_journals(arguments.out);
        seen.times = journal.last_run_times;
        seen.cases = journal.cases.size();
        fs::remove_all(folder);
    });
    if (code != ExitCode::done) throw UsageError("a case of the benchmark failed", code);
    return seen;
}

} // namespace

ExitCode bench_sweep(int tiny_cases, const Comm& world, Output& out) {
    const long process = world.broadcast(static_cast<long>(::getpid()));
    const fs::path folder = fmt::format("shearwake-bench-{}", process);
    const Seen tiny = run_job(folder, tiny_job(tiny_cases), world);
    const Seen mixed = run_job(folder, mixed_job(), world);
    if (!world.is_root()) return ExitCode::done;
    out.add("overhead per case and team", tiny.times.beside_solve_s, "s");
    out.add("small cases", tiny.seconds, "s");
    out.add("mixed cases", mixed.seconds, "s");
    out.add("idle share of the teams", mixed.times.idle_share, "1");
    out.print("\n{} rank{}, one rank per team, files in the working directory\n", world.size(),
              world.size() == 1 ? "" : "s");
    out.print("  {:6} small cases  {:8.2f} s   {:.2f} ms overhead per case and team\n", tiny.cases,
              tiny.seconds, 1e3 * tiny.times.beside_solve_s);
    out.print("  {:6} mixed cases  {:8.2f} s   teams are idle {:.1f} % of the time\n", mixed.cases,
              mixed.seconds, 100.0 * mixed.times.idle_share);
    return ExitCode::done;
}

} // namespace shearwake::bench
