// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/calibration.hpp"

#include "base/error.hpp"
#include "base/work_clock.hpp"
#include "engines/checkpoint.hpp"
#include "engines/engine.hpp"
#include "engines/registry/make_engine.hpp"
#include "parallel/agree.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/surface_recorder.hpp"
#include "schedule/cost/machine.hpp"
#include "storage/journal/journal.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstring>
#include <ctime>
#include <fmt/format.h>
#include <new>
#include <optional>
#include <sys/mman.h>
#include <vector>

namespace shearwake::cost {
namespace {

constexpr int least_repeats = 2, most_repeats = 8;
constexpr double enough_s = 0.05;

std::vector<engines::Calibration> all_calibrations() {
    std::vector<engines::Calibration> all = pipeline::receptor_calibrations();
    for (const auto& engine : engines::all_engines())
        for (engines::Calibration& one : engine->calibrations())
            all.push_back(std::move(one));
    return all;
}

bool contains(const std::vector<engines::Work>& work, const std::string& kind) {
    return std::ranges::any_of(work,
                               [&](const engines::Work& part) { return part.kind.name == kind; });
}

/// The work of a case, including the work that it shares with other cases if that is measured.
std::vector<engines::Work> work_in(const engines::Calibration& one) {
    const engines::Estimate e = engines::make_engine(one.physics.solver)->estimate(one.physics, 1);
    std::vector<engines::Work> work = e.work;
    for (const engines::Work& part : pipeline::receptors_work(one.physics))
        work.push_back(part);
    if (contains(e.shared, one.kind)) work.insert(work.end(), e.shared.begin(), e.shared.end());
    return work;
}

/// CPU seconds of this rank.
double core_s(const auto& task) {
    const std::clock_t began = std::clock();
    task();
    return static_cast<double>(std::clock() - began) / static_cast<double>(CLOCKS_PER_SEC);
}

/// Ends the run of an engine when a stop is requested, without saving anything.
class Interruption : public engines::Checkpoints {
public:
    explicit Interruption(std::function<bool()> stop) : stop_(std::move(stop)) {}
    bool due() override { return asked(); }
    void save(const std::function<void(StateWriter&)>&) override {}
    bool restore(const std::function<void(const StateReader&)>&) override { return false; }
    bool stop() const override { return asked(); }
    bool stop_asked() override { return asked(); }
    bool asked() const { return stop_ && stop_(); }

private:
    std::function<bool()> stop_;
};

/// Returns early if a stop was requested.
void run_alone(const Case& c, engines::Engine& engine, const Comm& alone, Interruption& stop) {
    pipeline::SurfaceRecorder recorder(c, alone, nullptr, {});
    pipeline::keep_receptors(c, recorder);
    engine.run(c, alone, recorder, &stop);
    if (stop.asked()) return;
    recorder.finish();
    const PlannedCase planned{
        .id = "calibration", .physics = c, .settings = {}, .reference_id = ""};
    if (c.afferents)
        pipeline::perceived(pipeline::receptor_motion(planned, recorder), *c.afferents, alone);
}

/// Measures the time of the stage to which the kind of work belongs, and returns it with the work
/// of this stage. If no clock times the stage, the time and work outside of all timed stages are
/// returned. The result is the mean of a few runs, as a job experiences it, not the best. A run
/// before the measurement makes the FFTW plans and the data that cases share. Wall-clock time is
/// scaled by the share of CPU time, since other processes slow the stage and the run alike.
engines::MeasuredWork measured_stage(const engines::Calibration& one, const Comm& alone,
                                     Interruption& stop) {
    const Case& c = one.physics;
    auto engine = engines::make_engine(c.solver);
    run_alone(c, *engine, alone, stop);
    const bool shared = contains(engine->estimate(c, 1).shared, one.kind);
    double all_s = 0.0, stage_s = 0.0;
    int runs = 0;
    std::set<std::string> timed;
    for (; runs < least_repeats || (runs < most_repeats && all_s < enough_s); ++runs) {
        if (stop.asked()) return {one.kind, {}, 0.0};
        if (shared) engine = engines::make_engine(c.solver);
        WorkClock clock;
        const auto began = Clock::now();
        const double of_core_s = core_s([&] { run_alone(c, *engine, alone, stop); });
        const double share = std::min(1.0, of_core_s / seconds_since(began));
        all_s += of_core_s;
        for (const engines::Work& part : work_in(one))
            if (clock.seconds(engines::stage_of(part.kind.name)) > 0.0)
                timed.insert(part.kind.name);
        stage_s +=
            share * clock.seconds(timed.contains(one.kind) ? engines::stage_of(one.kind) : "");
    }
    const bool is_timed = timed.contains(one.kind);
    std::vector<engines::Work> work = work_in(one);
    std::erase_if(work, [&](const engines::Work& part) {
        return is_timed ? engines::stage_of(part.kind.name) != engines::stage_of(one.kind)
                        : timed.contains(part.kind.name);
    });
    return {one.kind, work, stage_s / runs};
}

/// Seconds per byte for the first access to new memory. The allocator is bypassed, since it reuses
/// freed memory. On a virtual machine, memory that was freed recently is up to ten times faster, so
/// the result is the geometric mean of the measured and the assumed rate.
double fresh_memory_s() {
    constexpr std::size_t bytes = std::size_t{1} << 27;
    void* memory =
        ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    ::madvise(memory, bytes, MADV_HUGEPAGE); // as in aligned.hpp; failure is harmless
    const double seconds = core_s([&] { std::memset(memory, 1, bytes); });
    ::munmap(memory, bytes);
    return std::sqrt(seconds / static_cast<double>(bytes) * engines::of_fresh_memory.assumed_s);
}

/// Nothing if a stop was requested.
std::optional<engines::Rates> measured_rates(const std::set<std::string>& kinds,
                                             engines::Rates known, const Comm& world,
                                             Interruption& stop) {
    const Comm alone = world.split(world.rank());
    if (kinds.contains(engines::of_fresh_memory.name)) {
        world.barrier();
        double seconds = 0.0;
        together(world, [&] { seconds = fresh_memory_s(); });
        known[engines::of_fresh_memory.name] = std::max(world.max(seconds), 1e-12);
    }
    std::vector<engines::MeasuredWork> measured;
    for (const engines::Calibration& one : all_calibrations()) {
        if (!kinds.contains(one.kind)) continue;
        world.barrier();
        engines::MeasuredWork stage;
        together(world, [&] { stage = measured_stage(one, alone, stop); });
        if (world.any(stop.asked())) return std::nullopt;
        stage.seconds = world.max(stage.seconds);
        measured.push_back(std::move(stage));
    }
    return engines::solve_rates(measured, known);
}

/// Seconds of an all-to-all in which each rank sends `numbers` complex numbers to each other rank:
/// the median, as a run experiences it.
double all_to_all_s(const Comm& world, int numbers) {
    const auto ranks = static_cast<std::size_t>(world.size());
    const std::vector<std::ptrdiff_t> counts(ranks, numbers);
    const std::vector<std::complex<double>> sent(ranks * static_cast<std::size_t>(numbers));
    std::vector<std::complex<double>> received(sent.size());
    constexpr std::size_t repeats = 21;
    std::vector<double> all_s;
    for (std::size_t i = 0; i <= repeats; ++i) {
        world.barrier();
        const auto began = Clock::now();
        world.all_to_all(std::span<const std::complex<double>>(sent), counts, std::span(received),
                         counts);
        const double seconds = world.max(seconds_since(began));
        if (i > 0) all_s.push_back(seconds); // the first one sets up connections
    }
    const auto middle = all_s.begin() + repeats / 2;
    std::nth_element(all_s.begin(), middle, all_s.end());
    return *middle;
}

void measure_transposes(const Comm& world, Machine& machine) {
    if (world.size() == 1) return;
    const int many = std::max(1, (1 << 16) / world.size()); // 1 MiB per rank
    const double few_s = all_to_all_s(world, 1), many_s = all_to_all_s(world, many);
    machine.message_s = few_s / world.size();
    if (many_s > few_s) machine.transposed_B_s = 16.0 * many * world.size() / (many_s - few_s);
}

} // namespace

std::set<std::string> every_kind() {
    std::set<std::string> kinds = {engines::of_fresh_memory.name};
    for (const engines::Calibration& one : all_calibrations())
        kinds.insert(one.kind);
    return kinds;
}

std::set<std::string> kinds_to_measure(const std::set<std::string>& kinds,
                                       const engines::Rates& known) {
    const std::vector<engines::Calibration> all = all_calibrations();
    std::set<std::string> wanted = kinds, missing;
    for (bool grown = true; grown;) {
        grown = false;
        for (const engines::Calibration& one : all) {
            if (!wanted.contains(one.kind) || known.contains(one.kind)) continue;
            if (!missing.insert(one.kind).second) continue;
            grown = true;
            for (const engines::Work& part : work_in(one))
                wanted.insert(part.kind.name);
        }
    }
    if (wanted.contains(engines::of_fresh_memory.name) &&
        !known.contains(engines::of_fresh_memory.name))
        missing.insert(engines::of_fresh_memory.name);
    return missing;
}

namespace {

/// The engines and other parts of the program to which kinds of work belong: "pstd, receptors".
std::string parts_of(const std::set<std::string>& kinds) {
    std::set<std::string> parts;
    for (const std::string& kind : kinds)
        parts.insert(kind == engines::of_fresh_memory.name ? "memory"
                                                           : kind.substr(0, kind.find('.')));
    if (parts.empty()) parts.insert("files");
    return fmt::format("{}", fmt::join(parts, ", "));
}

} // namespace

Machine calibrated(const Machine& known, const std::set<std::string>& kinds, const Comm& world,
                   const CalibrationHooks& hooks) {
    const bool is_new = known.measured.empty();
    const std::set<std::string> missing = kinds_to_measure(kinds, known.rates);
    if (missing.empty() && !is_new) return known;
    if (world.is_root())
        hooks.report(
            fmt::format("calibrating the cost model for {} rank{} ({}): takes a few seconds per "
                        "engine, once per machine",
                        world.size(), world.size() == 1 ? "" : "s", parts_of(missing)));
    Machine machine = known;
    try {
        Interruption stop(hooks.stop);
        const auto rates = measured_rates(missing, known.rates, world, stop);
        if (!rates) return known;
        machine.rates = *rates;
        if (is_new) {
            measure_transposes(world, machine);
            const Comm alone = world.split(world.rank());
            on_root(world, [&] {
                if (!hooks.files.empty()) measure_files(hooks.files, alone, machine);
            });
        }
    } catch (const std::exception& error) { // thrown on all ranks: no memory, or no folder
        if (world.is_root())
            hooks.report(
                fmt::format("calibration failed, default rates are used: {}", error.what()));
        return known;
    }
    machine.measured = fmt::format("on {}, {} rank{}, {}", storage::host_name(), world.size(),
                                   world.size() == 1 ? "" : "s", storage::timestamp());
    return machine_of_root(machine, world);
}

void calibrate_for(CaseCosts& costs, int ranks, const Comm& world,
                   const std::function<void(const std::string&)>& report,
                   const std::function<bool()>& stop) {
    const std::set<std::string> kinds = costs.kinds();
    Machine machine = known_machine(ranks, world);
    // A plan for another number of ranks may be for another machine. If that machine has no
    // calibration, the rates of this machine's processor are the best estimate.
    const bool is_elsewhere = ranks != world.size();
    if (is_elsewhere &&
        (machine.measured.empty() || !kinds_to_measure(kinds, machine.rates).empty()))
        machine = known_machine(world.size(), world);
    const auto file = machine_file(world.size());
    const Machine now =
        calibrated(machine, kinds, world,
                   {report, file ? file->parent_path() : std::filesystem::path(), stop});
    if (world.is_root() && file && !(now == machine)) keep_machine(now, *file);
    costs.use(now);
}

} // namespace shearwake::cost
