// SPDX-License-Identifier: BSD-3-Clause
#include "kwave/run.hpp"

#include "base/text.hpp"
#include "base/units.hpp"
#include "engines/pstd/pstd_engine.hpp"
#include "engines/pstd/scene/case_step.hpp"
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
#include <fstream>
#include <memory>
#include <optional>
#include <unistd.h>
#include <xxhash.h>

namespace shearwake::kwave {
namespace {

/// Steps between two searches for values that are not finite.
constexpr long steps_between_checks = 50;

void print(const Comm& world, const std::string& line) {
    if (!world.is_root()) return;
    fmt::print("{}\n", line);
    std::fflush(stdout);
}

void check_arguments(const Arguments& a) {
    const auto refuse = [](const std::string& what) { throw UsageError(what); };
    if (!a.checkpoint.empty() && a.checkpoint_interval_s <= 0.0 && a.checkpoint_steps <= 0)
        refuse("--checkpoint_file requires --checkpoint_interval or --checkpoint_timesteps");
    if (a.checkpoint.empty() && (a.checkpoint_interval_s > 0.0 || a.checkpoint_steps > 0))
        refuse("--checkpoint_interval and --checkpoint_timesteps require --checkpoint_file");
    if (a.output.empty()) refuse("-o requires the name of a file, but is empty");
    for (const auto& path : {a.output, a.checkpoint}) {
        if (path.empty()) continue;
        std::error_code error;
        const auto folder = path.parent_path();
        if (!std::filesystem::is_directory(folder, error))
            refuse(fmt::format("{}: the folder does not exist", path.string()));
        if (::access(folder.c_str(), W_OK) != 0)
            refuse(fmt::format("{}: the folder is not writable", path.string()));
        const auto found = std::filesystem::status(path, error);
        if (found.type() == std::filesystem::file_type::none)
            refuse(fmt::format("{}: {}", path.string(), error.message()));
        if (std::filesystem::is_directory(found))
            refuse(fmt::format("{} is a folder", path.string()));
        if (std::filesystem::exists(found) && !std::filesystem::is_regular_file(found))
            refuse(fmt::format("{} is not a regular file", path.string()));
        if (std::filesystem::equivalent(path, a.input, error))
            refuse(fmt::format("{} would replace the input file", path.string()));
    }
    if (!a.checkpoint.empty() && std::filesystem::weakly_canonical(a.checkpoint) ==
                                     std::filesystem::weakly_canonical(a.output))
        refuse("the checkpoint and the output have the same name");
}

/// A hash of the input file and of everything else that determines the result. Not collective.
std::string identity_of(const Arguments& a, long steps) {
    std::ifstream file(a.input, std::ios::binary);
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                         XXH3_freeState);
    XXH3_64bits_reset(state.get());
    std::vector<char> block(1 << 20);
    while (file.read(block.data(), std::ssize(block)) || file.gcount() > 0)
        XXH3_64bits_update(state.get(), block.data(), static_cast<std::size_t>(file.gcount()));
    const std::string rest =
        fmt::format("{} {} {} {}", fmt::join(a.records, " "), a.first_step, steps, a.precision);
    XXH3_64bits_update(state.get(), rest.data(), rest.size());
    return fmt::format("{:016x}", XXH3_64bits_digest(state.get()));
}

/// An unstable step is an error, a step that may be unstable a warning. Collective.
void check_step(const Input& input, const std::string& name, const Comm& world) {
    const auto& grid = input.setup.grid;
    const double alone_s = world.min(input.limits.alone_s);
    if (grid.dt_s > alone_s)
        throw UsageError(fmt::format("{}: dt is {:.6g} s, which is unstable in this medium: steps "
                                     "above {:.6g} s are unstable",
                                     name, grid.dt_s, alone_s));
    if (input.study) return;
    pstd::Extremes extremes;
    extremes.p_modulus_Pa = world.max(input.limits.p_modulus_Pa);
    extremes.p_viscosity_Pa_s = world.max(input.limits.p_viscosity_Pa_s);
    extremes.least_density_kg_m3 = world.min(input.limits.density_kg_m3);
    const double safe_s = pstd::safe_step_s(extremes, pstd::cubic_spacing_m(grid));
    if (grid.dt_s > safe_s)
        print(world, fmt::format("warning: dt is {:.6g} s; steps up to {:.6g} s are stable for "
                                 "any arrangement of these materials",
                                 grid.dt_s, safe_s));
}

/// A run and its input.
struct Job {
    const Arguments& arguments;
    const Comm& world;
    Phases& phases;
    const Input& input;
    long steps;
    std::string name() const { return arguments.input.string(); }
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
    check_step(job.input, job.name(), job.world);
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
    const pstd::PstdPlan plan{
        .grid = setup.grid,
        .pml = setup.pml,
        .steps = static_cast<double>(job.steps),
        .absorption = setup.absorption,
        .precision = job.arguments.precision == "single" ? Precision::single_precision
                                                         : Precision::double_precision,
        .uneven = true,
        .coefficients = pstd::varying_coefficients(true, true, true, setup.absorption),
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
    const bool lossy = input.setup.absorption == pstd::Absorption::kelvin_voigt;
    print(world, fmt::format("{}: {} x {} x {} nodes, {} steps of {:.6g} s, {}, {} precision, {}",
                             job.name(), grid.points[0], grid.points[1], grid.points[2], job.steps,
                             grid.dt_s, lossy ? "Kelvin-Voigt" : "lossless", arguments.precision,
                             counted(world.size(), "rank")));
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

/// Restores the checkpoint, if there is one, after a check of its owner. Collective.
template <class Real>
void resume(const Job& job, const storage::CheckpointOwner& owner, pstd::Stepper<Real>& stepper,
            pstd::Recorder& recorder) {
    const auto& path = job.arguments.checkpoint;
    bool exists = false;
    on_root(job.world, [&] {
        if (!(exists = std::filesystem::exists(path))) return;
        storage::CheckpointFacts facts;
        if (const std::string error = storage::checkpoint_error(path, owner, facts); !error.empty())
            throw UsageError(
                fmt::format("{} {}; it must be a checkpoint of the same input file and options",
                            path.string(), error));
    });
    if (!job.world.broadcast(exists)) return;
    storage::CheckpointFileReader reader(path, job.world);
    stepper.restore(reader);
    recorder.restore(reader);
    reader.close();
    print(job.world, fmt::format("resumed after step {}", stepper.steps()));
}

/// Computes and records the steps. Returns whether it stops for a checkpoint. Collective.
template <class Real>
bool advance(const Job& job, pstd::Stepper<Real>& stepper, pstd::Recorder& recorder) {
    const Arguments& arguments = job.arguments;
    const long first = stepper.steps(), steps = job.steps;
    long reported = steps > 0 ? 100 * first / steps / arguments.progress_percent : 0;
    bool stops = false;
    while (stepper.steps() < steps && !stops) {
        stepper.step();
        recorder.add(stepper, job.world);
        const long done = stepper.steps();
        if (done == steps || (done - first) % steps_between_checks == 0)
            if (!std::isfinite(job.world.sum(stepper.kinetic_J())))
                throw UsageError(fmt::format(
                    "{}: the field is no longer finite at step {}, {:.6g} s; dt is probably "
                    "unstable, or the absorbing layer, which a larger MultiAxialPMLRatio "
                    "stabilises",
                    job.name(), done, static_cast<double>(done) * job.input.setup.grid.dt_s));
        if (!arguments.checkpoint.empty() && done < steps)
            stops = job.world.any(
                schedule::stop_requested() ||
                (arguments.checkpoint_steps > 0 && done - first >= arguments.checkpoint_steps) ||
                (arguments.checkpoint_interval_s > 0.0 &&
                 seconds_since(job.phases.began) >= arguments.checkpoint_interval_s));
        const long now = 100 * done / steps / arguments.progress_percent;
        if (now == reported && !stops) continue;
        reported = now;
        const double passed_s = seconds_since(job.phases.phase);
        print(job.world,
              fmt::format("{:4} %  step {} of {}, {:.1f} s passed, {:.1f} s to go",
                          100 * done / steps, done, steps, passed_s,
                          *schedule::time_left_s(passed_s, static_cast<double>(done - first),
                                                 static_cast<double>(steps - first))));
    }
    return stops;
}

/// Collective.
template <class Real>
void write_output(const Job& job, const pstd::Stepper<Real>& stepper,
                  const pstd::Recorder& recorder) {
    const Arguments& arguments = job.arguments;
    const std::filesystem::path part = arguments.output.string() + ".part";
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
            write_records(output, recorder, job.input, stepper, job.world);
            if (!job.world.is_root()) return;
            write_facts(output, arguments, job.input, job.steps, stepper.steps(), job.phases,
                        job.world.size(), memory_B);
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
template <class Real>
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

    pstd::Stepper<Real> stepper(input->setup, world);
    std::unique_ptr<pstd::Recorder> recorder;
    together(world, [&] {
        recorder = std::make_unique<pstd::Recorder>(input->sensor, stepper.slabs(),
                                                    arguments.records, arguments.first_step, steps);
    });
    storage::CheckpointOwner owner{.case_id = "", .git_id = pipeline::program_git_id()};
    if (!arguments.checkpoint.empty()) {
        on_root(world, [&] { owner.case_id = identity_of(arguments, steps); });
        resume(job, owner, stepper, *recorder);
    }
    phases.preparing_s = phases.next();
    const long first = stepper.steps();
    const bool stops = advance(job, stepper, *recorder);
    phases.stepping_s = phases.next();
    if (stops) {
        storage::CheckpointFileWriter writer(arguments.checkpoint, world);
        for (const auto& [name, value] : input->integers)
            if (name.size() == 2 && name[0] == 'N') writer.put(name, static_cast<double>(value));
        stepper.save(writer);
        recorder->save(writer);
        writer.commit(owner, {});
    }
    recorder->finish();
    write_output(job, stepper, *recorder);
    if (!stops && !arguments.checkpoint.empty() && world.is_root())
        std::filesystem::remove(arguments.checkpoint);
    print(world, stops ? fmt::format("stopped after step {}; repeat the command to resume from {}",
                                     stepper.steps(), arguments.checkpoint.string())
                       : fmt::format("{}: {:.1f} s, {:.3g} Mpoint/s", arguments.output.string(),
                                     seconds_since(phases.began),
                                     1e-6 * job.points() * static_cast<double>(steps - first) /
                                         std::max(phases.stepping_s, 1e-9)));
}

} // namespace

ExitCode run(const Arguments& given, const Comm& world) {
    Arguments arguments = given;
    if (arguments.records.empty()) arguments.records = {"p"};
    for (auto* path : {&arguments.output, &arguments.checkpoint})
        if (!path->empty()) *path = std::filesystem::absolute(*path);
    Phases phases;
    try {
        check_arguments(arguments);
        if (arguments.gpu >= 0) print(world, "note: -g is ignored: there is no GPU version");
        if (arguments.threads > 0 && arguments.threads != world.size())
            print(world, fmt::format("note: the run uses {} of the {} threads of -t: start {} "
                                     "ranks with mpirun -n {}, or with kspaceFirstOrder-elastic",
                                     world.size(), arguments.threads, arguments.threads,
                                     arguments.threads));
        // An older output must not be mistaken for the result of a run that fails; k-Wave's
        // functions read it without regard to the exit code. The output of an earlier leg states
        // its last step.
        on_root(world, [&] {
            if (arguments.checkpoint.empty() || !std::filesystem::exists(arguments.checkpoint))
                std::filesystem::remove(arguments.output);
        });
        if (!arguments.checkpoint.empty()) schedule::watch_for_stop_signals(world);
        fail_together(world, [&] {
            if (arguments.precision == "single")
                run_with<float>(arguments, world, phases);
            else
                run_with<double>(arguments, world, phases);
        });
    } catch (const Error& error) { // thrown on all ranks
        std::error_code ignored;
        const bool is_older = std::filesystem::exists(arguments.output, ignored);
        throw UsageError(error.what() +
                             (is_older ? "; " + arguments.output.string() + " is of an earlier run"
                                       : std::string()),
                         ExitCode::internal);
    }
    return ExitCode::done;
}

} // namespace shearwake::kwave
