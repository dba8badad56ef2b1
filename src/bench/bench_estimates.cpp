// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.hpp"

#include "base/error.hpp"
#include "bench/bench_jobs.hpp"
#include "engines/registry/make_engine.hpp"
#include "parallel/agree.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/run_case.hpp"
#include "schedule/cost/calibration.hpp"
#include "schedule/cost/case_costs.hpp"
#include "storage/files.hpp"

#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <cmath>
#include <map>
#include <malloc.h>
#include <unistd.h>

namespace shearwake::bench {
namespace {

namespace fs = std::filesystem;

struct Amounts {
    double seconds = 0.0, core_s = 0.0, memory_B = 0.0, disk_B = 0.0;
    std::map<std::string, double> stages_s; // by name of the stage, on the slowest rank
};

/// A stage is listed if the error of its estimate exceeds this share of the time of its case.
constexpr double noteworthy = 0.1;

/// Returns free memory to the system and resets the peak of the resident memory.
void forget_peak_memory() {
    ::malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";
}

/// The peak of the resident memory since forget_peak_memory().
double peak_since_B() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return 1024.0 * std::stod(line.substr(6));
    return 0.0;
}

/// A case of two frames, whose run measures the FFTW plans that the complete case needs.
Case shortened(Case c) {
    if (c.study()) return c;
    c.time.frames = 2;
    c.measure.at_s = c.time.duration_s();
    c.measure.settled_after_s = 0.0;
    c.record.volumes_s.clear();
    c.record.volume_fields.clear();
    c.afferents.reset();
    return c;
}

/// Computes the case as `run` does: engine, measures, receptors, file.
void compute(const Case& c, const Comm& world, const fs::path& folder) {
    const PlannedCase planned{.id = "case", .physics = c, .settings = {}, .reference_id = ""};
    const storage::Journal journal(folder / storage::journal_name(""));
    pipeline::CaseCheckpoints checkpoints(folder / "case.state", {planned.id, ""}, {}, world,
                                          journal,
                                          {[] { return false; }, [](const std::string&) {}});
    const auto engine = engines::make_engine(c.solver);
    pipeline::run_case(planned, {.memory_per_rank_B = std::numeric_limits<double>::infinity()},
                       *engine, world, folder / "case.h5", checkpoints, [] {});
}

/// Seconds of a rank by name of the stage.
std::map<std::string, double> stages_of(const std::vector<engines::Work>& work,
                                        const engines::Rates& rates, int ranks) {
    std::map<std::string, double> seconds;
    for (const engines::Work& part : work)
        seconds[std::string(engines::stage_of(part.kind.name))] +=
            engines::time_s(part, rates) / ranks;
    return seconds;
}

Amounts measured(const Case& c, const Comm& world, const fs::path& folder,
                 const std::map<std::string, double>& stages) {
    compute(shortened(c), world, folder);
    Amounts found;
    forget_peak_memory();
    const std::clock_t began = std::clock();
    WorkClock clock;
    found.seconds = seconds_of(world, [&] { compute(c, world, folder); });
    found.core_s =
        world.max(static_cast<double>(std::clock() - began) / static_cast<double>(CLOCKS_PER_SEC));
    for (const auto& [stage, unused] : stages)
        found.stages_s[stage] = world.max(clock.seconds(stage));
    found.memory_B = world.max(peak_since_B());
    double disk_B = 0.0;
    on_root(world, [&] { disk_B = static_cast<double>(fs::file_size(folder / "case.h5")); });
    found.disk_B = world.broadcast(disk_B);
    return found;
}

Amounts estimated(const Case& c, int ranks, cost::CaseCosts& costs) {
    const cost::CaseCost& cost = costs.of(c);
    const cost::Machine& machine = costs.machine();
    return {.seconds = cost::seconds_on(cost, ranks, 1, machine) +
                       cost::shared_seconds_on(cost, ranks, machine),
            .memory_B = costs.memory_per_rank_B(c, ranks),
            .disk_B = cost.written_B,
            .stages_s = stages_of(costs.work_of(c), machine.rates, ranks)};
}

void print_stages(Output& out, const Amounts& e, const Amounts& m) {
    for (const auto& [stage, estimated_s] : e.stages_s) {
        const double measured_s = m.stages_s.at(stage);
        if (measured_s > 0.0 && std::abs(estimated_s - measured_s) > noteworthy * m.seconds)
            out.print("    {:<26}  {:7.3f} {:8.3f}\n", stage, estimated_s, measured_s);
    }
}

void add(Output& out, const std::string& name, const Amounts& e, const Amounts& m) {
    out.add(name + ": estimated time", e.seconds, "s");
    out.add(name + ": time", m.seconds, "s");
    out.add(name + ": estimated memory per rank", e.memory_B, "B");
    out.add(name + ": memory per rank", m.memory_B, "B");
    out.add(name + ": estimated disk space", e.disk_B, "B");
    out.add(name + ": disk space", m.disk_B, "B");
}

} // namespace

ExitCode bench_estimates(const Comm& world, Output& out) {
    std::vector<PlannedCase> planned;
    for (BenchJob& job : bench_jobs())
        planned.push_back({job.name, std::move(job.physics), {}, false, ""});
    std::vector<const PlannedCase*> cases;
    for (const PlannedCase& one : planned)
        cases.push_back(&one);
    cost::CaseCosts costs(cases, {});
    calibrate_for(costs, world.size(), world,
                  [&](const std::string& text) { out.print("{}\n", text); });
    const fs::path folder =
        world.broadcast(world.is_root() ? fmt::format("shearwake-bench-{}", ::getpid()) : "");
    on_root(world, [&] { storage::make_directory(folder); });
    if (world.is_root())
        out.print("{:<30}  {:^31}   {:^22}   {:^22}\n"
                  "{:<30}  {:>7} {:>8} {:>7} {:>6}   {:>7} {:>7} {:>6}   {:>7} {:>7} {:>6}\n",
                  fmt::format("{} rank{}", world.size(), world.size() == 1 ? "" : "s"), "time, s",
                  "memory per rank, MB", "disk, MB", "", "est.", "measured", "core", "ratio",
                  "est.", "meas.", "ratio", "est.", "meas.", "ratio");
    for (const PlannedCase& one : planned) {
        const Amounts e = estimated(one.physics, world.size(), costs);
        const Amounts m = measured(one.physics, world, folder, e.stages_s);
        if (world.is_root())
            out.print("{:<30}  {:7.3f} {:8.3f} {:7.3f} {:6.2f}   {:7.0f} {:7.0f} {:6.2f}   "
                      "{:7.3f} {:7.3f} {:6.2f}\n",
                      one.id, e.seconds, m.seconds, m.core_s, e.seconds / m.seconds,
                      e.memory_B / 1e6, m.memory_B / 1e6, e.memory_B / m.memory_B, e.disk_B / 1e6,
                      m.disk_B / 1e6, e.disk_B / m.disk_B);
        if (world.is_root()) add(out, one.id, e, m);
        if (world.is_root()) print_stages(out, e, m);
    }
    on_root(world, [&] { fs::remove_all(folder); });
    return ExitCode::done;
}

} // namespace shearwake::bench
