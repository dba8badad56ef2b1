// SPDX-License-Identifier: BSD-3-Clause
#include "kwave/run.hpp"

#include "base/text.hpp"
#include "base/units.hpp"
#include "engines/march.hpp"
#include "engines/pstd/make_scheme.hpp"
#include "engines/pstd/pstd_engine.hpp"
#include "kwave/files.hpp"
#include "parallel/agree.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/run/deadline.hpp"
#include "schedule/run/progress.hpp"
#include "storage/checkpoint/checkpoint_file.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <optional>
#include <vector>

namespace shearwake::kwave {
namespace {

/// Steps between two searches for values that are not finite.
constexpr long steps_between_checks = 50;

void print(const Comm& world, const std::string& line) {
    if (!world.is_root()) return;
    fmt::print("{}\n", line);
    std::fflush(stdout);
}

/// A run and its input.
struct Job {
    const Arguments& arguments;
    const Comm& world;
    Phases& phases;
    const Input& input;
    long steps;
    std::string name() const { return arguments.input.string(); }
    Precision precision() const {
        return arguments.precision == "single" ? Precision::single_precision
                                               : Precision::double_precision;
    }
    pstd::DeviceChoice device() const {
        return {arguments.device == "gpu" ? PstdDevice::gpu : PstdDevice::cpu, arguments.gpu};
    }
    double points() const {
        const auto& n = input.setup.grid.points;
        return static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]);
    }
};

/// Collective.
void check_input(const Job& job) {
    const auto& records = job.arguments.records;
    if (job.arguments.first_step > job.steps)
        throw UsageError(fmt::format("{}: -s is {}; it must be 1 to the {} steps of the run",
                                     job.name(), job.arguments.first_step, job.steps));
    if (const std::string warning = check_step(job.input, job.name(), job.world); !warning.empty())
        print(job.world, "warning: " + warning);
    const bool of_points = std::any_of(records.begin(), records.end(), [](const auto& record) {
        return !record.ends_with("_all") && !record.ends_with("_final");
    });
    if (of_points && job.input.sensor.size() == 0)
        throw UsageError(fmt::format("{}: the sensor has no points; only records of the entire "
                                     "grid (--p_final, ...) are available",
                                     job.name()));
}

/// The memory in bytes that each rank needs. Not collective.
double required_memory_B(const Job& job) {
    const pstd::Setup& setup = job.input.setup;
    double source_nodes = 0.0;
    for (const pstd::Source& source : setup.sources)
        source_nodes += static_cast<double>(source.nodes.size());
    const pstd::PstdPlan plan{.grid = setup.grid,
                              .pml = setup.pml,
                              .steps = static_cast<double>(job.steps),
                              .absorption = setup.absorption,
                              .precision = job.precision(),
                              .device = job.device(),
                              .uneven = true,
                              .coefficients = pstd::varying_coefficients({}, setup.absorption),
                              .source_nodes = source_nodes,
                              .places = {.planes = 0}};
    const engines::Resources planned{.arrays = pstd::arrays_of(plan, job.world.size())};
    return planned.memory_per_rank_B() +
           pstd::Recorder::memory_B(job.input.sensor, setup.grid, job.arguments.records,
                                    job.steps - job.arguments.first_step + 1, job.world.size());
}

/// Collective.
void describe(const Job& job, double required_B) {
    const Arguments& arguments = job.arguments;
    const Comm& world = job.world;
    const Input& input = job.input;
    const auto& grid = input.setup.grid;
    const Shape shape = kwave_shape(grid, grid.points);
    const bool lossy = input.setup.absorption == pstd::Absorption::kelvin_voigt;
    print(world, fmt::format("{}: {} x {} x {} nodes, {} steps of {:.6g} s, {}, {} precision, {}",
                             job.name(), shape[2], shape[1], shape[0], job.steps, grid.dt_s,
                             lossy ? "Kelvin-Voigt" : "lossless", arguments.precision,
                             counted(world.size(), "rank")));
    if (grid.is_plane && world.size() > 1)
        print(world, fmt::format("note: one of the {} ranks computes the plane of a file with "
                                 "Nz = 1; the others are idle",
                                 world.size()));
    if (const double faces = world.sum(input.fluid_faces); faces > 0.0)
        print(world, fmt::format("note: {:.0f} faces between fluid and solid nodes; the shear "
                                 "moduli next to them are those of the file",
                                 faces));
    if (const double nodes = world.sum(input.soft_nodes); nodes > 0.0)
        print(world,
              fmt::format("warning: lambda + 2 mu/3, the bulk modulus, is negative at {:.0f} "
                          "nodes, which no stable solid has",
                          nodes));
    if (arguments.verbose > 0)
        print(world, fmt::format("  {} sensor nodes, {} sources; records {}", input.sensor.size(),
                                 input.setup.sources.size(), fmt::join(arguments.records, ", ")));
    if (arguments.verbose > 1)
        print(world, fmt::format("  about {:.3g} GB per rank", 1e-9 * required_B));
}

/// The scheme and the records of a run.
class Simulation : public engines::Marching {
public:
    /// `job` must outlive this object. Collective.
    explicit Simulation(const Job& job)
        : job_(job),
          scheme_(pstd::make_scheme(job.input.setup, job.precision(), job.device(), job.world)) {
        together(job.world, [&] {
            recorder_ =
                std::make_unique<pstd::Recorder>(job.input.sensor, *scheme_, job.arguments.records,
                                                 job.arguments.first_step, job.steps);
        });
    }
    const pstd::Scheme& scheme() const { return *scheme_; }
    pstd::Recorder& recorder() { return *recorder_; }

    std::ptrdiff_t step() const override { return scheme_->steps(); }
    void advance() override {
        scheme_->step();
        recorder_->add(job_.world);
        const long done = scheme_->steps();
        if (done != job_.steps && done % steps_between_checks != 0) return;
        if (!std::isfinite(job_.world.sum(scheme_->kinetic_J())))
            throw UsageError(fmt::format(
                "{}: the field is no longer finite at step {}, {:.6g} s; dt is probably "
                "unstable, or the absorbing layer, which a larger MultiAxialPMLRatio stabilises",
                job_.name(), done, static_cast<double>(done) * job_.input.setup.grid.dt_s));
    }
    void emit(engines::Observer& /*observer*/) override {} // the recorder has all output
    void save(StateWriter& state) const override {
        scheme_->save(state);
        recorder_->save(state);
    }
    void restore(const StateReader& state) override {
        scheme_->restore(state);
        recorder_->restore(state);
    }

private:
    const Job& job_;
    std::unique_ptr<pstd::Scheme> scheme_;
    std::unique_ptr<pstd::Recorder> recorder_;
};

/// Receives nothing, since a simulation has its records itself.
class NoObserver : public engines::Observer {
    void begin(const engines::Slab&) override {}
    void frame(const engines::Frame&) override {}
    void stress(const engines::StressFrame&) override {}
    void tangential(const engines::TangentialFrame&) override {}
    void volume_levels(const std::vector<double>&) override {}
    void volume(const engines::VolumePlane&) override {}
    void solved(const engines::SolverReport&) override {}
    void save(StateWriter&) override {}
    void restore(const StateReader&) override {}
};

/// The steps from the start, or from a checkpoint, to the end or to the next checkpoint.
class Leg : public engines::Checkpoints {
public:
    /// Both must outlive this object. Collective.
    Leg(const Job& job, const engines::Marching& field)
        : job_(job), field_(field),
          path_(job.arguments.checkpoint), owner_{.case_id = "",
                                                  .git_id = pipeline::program_git_id()} {
        if (path_.empty()) return;
        on_root(job.world, [&] { owner_.case_id = identity_of(job.arguments, job.steps); });
    }
    long first() const { return first_; }

    bool due() override {
        const Arguments& a = job_.arguments;
        return !path_.empty() &&
               job_.world.any(
                   schedule::stop_requested() ||
                   (a.checkpoint_steps > 0 && field_.step() - first_ >= a.checkpoint_steps) ||
                   (a.checkpoint_interval_s > 0.0 &&
                    seconds_since(job_.phases.began) >= a.checkpoint_interval_s));
    }
    void save(const std::function<void(StateWriter&)>& write) override {
        storage::CheckpointFileWriter writer(path_, job_.world);
        for (const auto& [name, value] : job_.input.integers)
            if (name.size() == 2 && name[0] == 'N') writer.put(name, static_cast<double>(value));
        write(writer);
        on_root(job_.world, [&] {
            if (std::filesystem::exists(path_))
                std::filesystem::rename(path_, previous_checkpoint(path_));
        });
        writer.commit(owner_, {});
    }
    /// Uses the previous checkpoint if the last one is damaged. A checkpoint of another run is an
    /// error.
    bool restore(const std::function<void(const StateReader&)>& read) override {
        if (path_.empty()) return false;
        std::string used;
        on_root(job_.world, [&] { used = usable_checkpoint(path_, owner_).string(); });
        used = job_.world.broadcast(std::move(used));
        if (used.empty()) return false;
        storage::CheckpointFileReader reader(used, job_.world);
        read(reader);
        reader.close();
        print(job_.world, fmt::format("resumed after step {}", field_.step()));
        return true;
    }
    bool stop() const override { return true; }
    bool stop_asked() override { return false; } // due() asks after every step
    void progressed(double /*share*/) override {
        const long done = field_.step(),
                   now = 100 * done / job_.steps / job_.arguments.progress_percent;
        if (reported_ < 0) {
            first_ = done;
            job_.phases.preparing_s = job_.phases.next();
        } else if (now != reported_) {
            const double passed_s = seconds_since(job_.phases.phase);
            print(job_.world,
                  fmt::format("{:4} %  step {} of {}, {:.1f} s passed, {:.1f} s to go",
                              100 * done / job_.steps, done, job_.steps, passed_s,
                              *schedule::time_left_s(passed_s, static_cast<double>(done - first_),
                                                     static_cast<double>(job_.steps - first_))));
        }
        reported_ = now;
    }

private:
    const Job& job_;
    const engines::Marching& field_;
    const std::filesystem::path& path_;
    storage::CheckpointOwner owner_;
    long first_ = 0, reported_ = -1; // the step at the start; the last interval of progress
};

/// Collective.
void write_output(const Job& job, const pstd::Recorder& recorder, long done) {
    const Arguments& arguments = job.arguments;
    std::filesystem::path part;
    if (job.world.is_root()) part = storage::part_path(arguments.output);
    const double memory_B = job.world.sum(pipeline::peak_memory_B());
    try {
        fail_together(job.world, [&] {
            OutputFile output{.doubles = arguments.output_precision == "double",
                              .gzip_level = arguments.gzip_level};
            h5::Id file;
            if (job.world.is_root()) {
                file = h5::open_file(part, h5::Access::create);
                output.file = file.raw();
            }
            write_records(output, recorder, job.input, job.world);
            if (!job.world.is_root()) return;
            write_facts(output, arguments, job.input, job.steps, done, job.phases, job.world.size(),
                        memory_B);
            file.close("write " + part.string());
            storage::publish(part, arguments.output);
        });
    } catch (const Error&) {
        std::error_code ignored;
        if (job.world.is_root()) std::filesystem::remove(part, ignored);
        throw;
    }
}

/// Advances, records, and writes output and checkpoint.
void run_with(const Arguments& arguments, const Comm& world, Phases& phases) {
    std::optional<Input> input;
    const double available_B = pipeline::memory_per_rank_B(world);
    together(world,
             [&] { input = read_input(arguments.input, world.size(), world.rank(), available_B); });
    phases.loading_s = phases.next();
    const long given = static_cast<long>(input->steps),
               steps = arguments.steps > 0 ? std::min(arguments.steps, given) : given;
    const Job job{arguments, world, phases, *input, steps};
    check_input(job);
    const double required_B = required_memory_B(job);
    if (required_B > available_B)
        throw UsageError(fmt::format("{}: the run needs {:.3g} GB per rank, but only {:.3g} GB are "
                                     "available; record fewer nodes or use more machines",
                                     job.name(), 1e-9 * required_B, 1e-9 * available_B));
    describe(job, required_B);

    Simulation field(job);
    const std::string device = field.scheme().device_name();
    if (!device.empty()) print(world, fmt::format("device: {}", device));
    Leg leg(job, field);
    NoObserver nobody;
    const bool stops = engines::march(field, steps, nobody, &leg) == engines::MarchEnd::stopped;
    phases.stepping_s = phases.next();
    field.recorder().finish();
    write_output(job, field.recorder(), field.step());
    if (!stops && !arguments.checkpoint.empty() && world.is_root()) {
        std::filesystem::remove(arguments.checkpoint);
        std::filesystem::remove(previous_checkpoint(arguments.checkpoint));
    }
    if (stops) {
        print(world, fmt::format("stopped after step {}; repeat the command to resume from {}",
                                 field.step(), arguments.checkpoint.string()));
        return;
    }
    const double steps_per_s =
        static_cast<double>(steps - leg.first()) / std::max(phases.stepping_s, 1e-9);
    const std::string share =
        device.empty() ? ""
                       : fmt::format(", {:.0f} % of the bandwidth of copies on the device",
                                     100.0 * field.scheme().copy_share(steps_per_s));
    print(world,
          fmt::format("{}: {:.1f} s, {:.3g} Mpoint/s{}", arguments.output.string(),
                      seconds_since(phases.began), 1e-6 * job.points() * steps_per_s, share));
}

/// With the exit code of k-Wave's programs; states that the output is not that of this run.
[[noreturn]] void end_run(const Arguments& arguments, const Error& error) {
    std::error_code ignored;
    const bool is_older = std::filesystem::exists(arguments.output, ignored);
    throw UsageError(
        error.what() +
            (is_older ? "; " + arguments.output.string() + " is of an earlier run" : std::string()),
        ExitCode::internal);
}

} // namespace

ExitCode run(const Arguments& given, const Comm& world) {
    Arguments arguments = given;
    if (arguments.records.empty()) arguments.records = {"p"};
    for (auto* path : {&arguments.output, &arguments.checkpoint})
        if (!path->empty()) *path = std::filesystem::absolute(*path);
    Phases phases;
    Locks locks;
    bool are_checked = false;
    try {
        check_arguments(arguments);
        are_checked = true;
        on_root(world, [&] { locks = lock_files({arguments.output, arguments.checkpoint}); });
    } catch (const UsageError& error) {
        if (are_checked && error.code() == ExitCode::usage) throw; // another run writes the file
        end_run(arguments, error);
    }
    try {
        if (arguments.gpu >= 0 && arguments.device != "gpu")
            print(world, "note: -g is ignored without --device gpu");
        if (arguments.threads > 0 && arguments.threads != world.size())
            print(world, fmt::format("note: the run uses {} of the {} threads of -t: start {} "
                                     "ranks with mpirun -n {}, or with kspaceFirstOrder-elastic",
                                     world.size(), arguments.threads, arguments.threads,
                                     arguments.threads));
        // An older output must not be mistaken for the result of a run that fails; k-Wave's
        // functions read it without regard to the exit code. The output of an earlier leg states
        // its last step.
        on_root(world, [&] {
            if (arguments.checkpoint.empty() ||
                !(std::filesystem::exists(arguments.checkpoint) ||
                  std::filesystem::exists(previous_checkpoint(arguments.checkpoint))))
                std::filesystem::remove(arguments.output);
        });
        if (!arguments.checkpoint.empty()) schedule::watch_for_stop_signals(world);
        fail_together(world, [&] { run_with(arguments, world, phases); });
    } catch (const Error& error) { // thrown on all ranks
        end_run(arguments, error);
    }
    return ExitCode::done;
}

} // namespace shearwake::kwave
