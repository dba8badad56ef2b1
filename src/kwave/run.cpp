// SPDX-License-Identifier: BSD-3-Clause
#include "kwave/run.hpp"

#include "base/units.hpp"
#include "engines/pstd/pstd_plan.hpp"
#include "engines/pstd/scene/case_step.hpp"
#include "kwave/input.hpp"
#include "kwave/output.hpp"
#include "parallel/agree.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/provenance.hpp"
#include "schedule/run/deadline.hpp"
#include "storage/checkpoint/checkpoint_file.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <fmt/chrono.h>
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
    std::error_code ignored;
    for (const auto& path : {a.output, a.checkpoint}) {
        if (path.empty()) continue;
        const auto folder = path.parent_path();
        if (!std::filesystem::is_directory(folder))
            refuse(fmt::format("{}: the folder does not exist", path.string()));
        if (::access(folder.c_str(), W_OK) != 0)
            refuse(fmt::format("{}: the folder is not writable", path.string()));
        if (std::filesystem::is_directory(path))
            refuse(fmt::format("{} is a folder", path.string()));
        if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path))
            refuse(fmt::format("{} is not a regular file", path.string()));
        if (std::filesystem::equivalent(path, a.input, ignored))
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

/// Times of the phases of a run, for the output file.
struct Phases {
    double loading_s = 0.0, preparing_s = 0.0, stepping_s = 0.0;
    Clock::time_point began = Clock::now(), phase = began;
    double next() {
        const auto now = Clock::now(), from = std::exchange(phase, now);
        return seconds_between(from, now);
    }
};

/// Scalars and attributes of the output file. Not collective.
void write_facts(const OutputFile& output, const Arguments& arguments, const Input& input,
                 long steps, long done, Phases& phases, int ranks, double memory_B) {
    constexpr hsize_t one[] = {1, 1, 1};
    const auto write = [&](const std::string& name, std::span<const hsize_t> shape, Numbers numbers,
                           const void* values) {
        const hid_t type = numbers == Numbers::integer ? H5T_NATIVE_UINT64 : H5T_NATIVE_DOUBLE;
        h5::check(H5Dwrite(create_dataset(output, name, shape, numbers).raw(), type, H5S_ALL,
                           H5S_ALL, H5P_DEFAULT, values),
                  "write " + name);
    };
    std::map<std::string, std::uint64_t> integers = input.integers;
    integers["Nt"] = static_cast<std::uint64_t>(steps);
    integers["t_index"] = static_cast<std::uint64_t>(done);
    for (const auto& [name, value] : integers)
        if (!name.starts_with("sensor_mask")) write(name, one, Numbers::integer, &value);
    for (const auto& [name, value] : input.numbers)
        write(name, one, Numbers::real, &value);
    if (arguments.copies_sensor_mask) {
        const auto& n = input.setup.grid.points;
        std::vector<std::uint64_t> values;
        const std::uint64_t type = input.cuboids.empty() ? 0u : 1u;
        write("sensor_mask_type", one, Numbers::integer, &type);
        std::array<hsize_t, 3> shape = {1, 1, 0};
        if (input.cuboids.empty()) {
            for (const pstd::Node& node : input.sensor.nodes)
                values.push_back(
                    static_cast<std::uint64_t>((node[2] * n[1] + node[1]) * n[0] + node[0] + 1));
            shape[2] = values.size();
        } else {
            for (const Cuboid& cuboid : input.cuboids)
                for (const pstd::Node& corner : {cuboid.first, cuboid.last})
                    for (const std::ptrdiff_t index : corner)
                        values.push_back(static_cast<std::uint64_t>(index + 1));
            shape = {1, input.cuboids.size(), 6};
        }
        write(type == 0 ? "sensor_mask_index" : "sensor_mask_corners", shape, Numbers::integer,
              values.data());
    }
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    const std::time_t now = std::time(nullptr);
    const auto seconds = [](double s) { return fmt::format("{:8.2f}s", s); };
    for (const auto& [name, value] : std::initializer_list<std::pair<const char*, std::string>>{
             {"file_type", "output"},
             {"created_by", "shearwake " + pipeline::program_git_id()},
             {"creation_date", fmt::format("{:%d/%m/%y, %H:%M:%S}", fmt::localtime(now))},
             {"file_description", input.description},
             {"major_version", "1"},
             {"minor_version", "2"},
             {"host_names", host.data()},
             {"number_of_cpu_cores", std::to_string(ranks)},
             {"data_loading_phase_execution_time", seconds(phases.loading_s)},
             {"pre-processing_phase_execution_time", seconds(phases.preparing_s)},
             {"simulation_phase_execution_time", seconds(phases.stepping_s)},
             {"post-processing_phase_execution_time", seconds(phases.next())},
             {"total_execution_time", seconds(seconds_since(phases.began))},
             {"peak_core_memory_in_use", fmt::format("{:.0f} MB", 1e-6 * memory_B / ranks)},
             {"total_memory_in_use", fmt::format("{:.0f} MB", 1e-6 * memory_B)}})
        h5::put_attribute(output.file, name, value);
}

/// Advances, records, and writes output and checkpoint.
template <class Real>
void run_with(const Arguments& arguments, const Comm& world, Phases& phases) {
    std::optional<Input> input;
    const double available_B = pipeline::memory_per_rank_B(world);
    together(world,
             [&] { input = read_input(arguments.input, world.size(), world.rank(), available_B); });
    phases.loading_s = phases.next();
    const auto& grid = input->setup.grid;
    const long steps = arguments.steps > 0
                           ? std::min(arguments.steps, static_cast<long>(input->steps))
                           : static_cast<long>(input->steps);
    if (arguments.first_step > steps)
        throw UsageError(fmt::format("{}: -s is {}; it must be 1 to the {} steps of the run",
                                     arguments.input.string(), arguments.first_step, steps));
    check_step(*input, arguments.input.string(), world);
    const bool of_points =
        std::any_of(arguments.records.begin(), arguments.records.end(), [](const auto& record) {
            return !record.ends_with("_all") && !record.ends_with("_final");
        });
    if (of_points && input->sensor.size() == 0)
        throw UsageError(fmt::format("{}: the sensor has no points; only records of the entire "
                                     "grid (--p_final, ...) are available",
                                     arguments.input.string()));

    const double points = static_cast<double>(grid.points[0]) *
                          static_cast<double>(grid.points[1]) * static_cast<double>(grid.points[2]);
    const bool lossy = input->setup.absorption == pstd::Absorption::kelvin_voigt;
    double source_nodes = 0.0;
    for (const pstd::Source& source : input->setup.sources)
        source_nodes += static_cast<double>(source.nodes.size());
    const pstd::PstdPlan plan{
        .grid = input->setup.grid,
        .pml = input->setup.pml,
        .steps = static_cast<double>(steps),
        .absorption = input->setup.absorption,
        .precision = sizeof(Real) == 4 ? Precision::single_precision : Precision::double_precision,
        .uneven = true,
        .coefficients = pstd::varying_coefficients(true, true, true, input->setup.absorption),
        .source_nodes = source_nodes};
    const engines::Resources planned{.arrays = pstd::arrays_of(plan, world.size())};
    const double needed_B =
        planned.memory_per_rank_B() +
        pstd::Recorder::memory_B(input->sensor, grid, arguments.records,
                                 steps - arguments.first_step + 1, world.size());
    if (needed_B > available_B)
        throw UsageError(fmt::format("{}: the run needs {:.3g} GB per rank, but only {:.3g} GB are "
                                     "available; record fewer nodes or use more machines",
                                     arguments.input.string(), 1e-9 * needed_B,
                                     1e-9 * available_B));
    print(world, fmt::format("{}: {} x {} x {} nodes, {} steps of {:.6g} s, {}, {} precision, {} "
                             "rank{}",
                             arguments.input.string(), grid.points[0], grid.points[1],
                             grid.points[2], steps, grid.dt_s, lossy ? "Kelvin-Voigt" : "lossless",
                             arguments.precision, world.size(), world.size() == 1 ? "" : "s"));
    if (const double faces = world.sum(input->fluid_faces); faces > 0.0)
        print(world, fmt::format("note: {:.0f} faces between fluid and solid nodes; the shear "
                                 "moduli next to them are those of the file",
                                 faces));
    if (const double nodes = world.sum(input->soft_nodes); nodes > 0.0)
        print(world,
              fmt::format("warning: lambda + 2 mu/3, the bulk modulus, is negative at {:.0f} "
                          "nodes, which no stable solid has",
                          nodes));
    if (arguments.verbose > 0)
        print(world, fmt::format("  {} sensor nodes, {} sources; records {}", input->sensor.size(),
                                 input->setup.sources.size(), fmt::join(arguments.records, ", ")));
    if (arguments.verbose > 1)
        print(world, fmt::format("  about {:.3g} GB per rank", 1e-9 * needed_B));

    pstd::Stepper<Real> stepper(input->setup, world);
    std::unique_ptr<pstd::Recorder> recorder;
    together(world, [&] {
        recorder = std::make_unique<pstd::Recorder>(input->sensor, stepper.slabs(),
                                                    arguments.records, arguments.first_step, steps);
    });
    storage::CheckpointOwner owner{.case_id = "", .git_id = pipeline::program_git_id()};
    if (!arguments.checkpoint.empty()) {
        on_root(world, [&] { owner.case_id = identity_of(arguments, steps); });
        bool exists = false;
        on_root(world, [&] {
            if (!(exists = std::filesystem::exists(arguments.checkpoint))) return;
            storage::CheckpointFacts facts;
            if (const std::string error =
                    storage::checkpoint_error(arguments.checkpoint, owner, facts);
                !error.empty())
                throw UsageError(
                    fmt::format("{} {}; it must be a checkpoint of the same input file and options",
                                arguments.checkpoint.string(), error));
        });
        if (world.broadcast(exists)) {
            storage::CheckpointFileReader reader(arguments.checkpoint, world);
            if (const std::string damage = reader.damage(); !damage.empty())
                throw UsageError(
                    fmt::format("{} is damaged: {}", arguments.checkpoint.string(), damage));
            stepper.restore(reader);
            recorder->restore(reader);
            reader.close();
            print(world, fmt::format("resumed after step {}", stepper.steps()));
        }
    }
    phases.preparing_s = phases.next();

    const long first = stepper.steps();
    long reported = steps > 0 ? 100 * first / steps / arguments.progress_percent : 0;
    bool stops = false;
    while (stepper.steps() < steps && !stops) {
        stepper.step();
        recorder->add(stepper, world);
        const long done = stepper.steps();
        if (done == steps || (done - first) % steps_between_checks == 0)
            if (!std::isfinite(world.sum(stepper.kinetic_J())))
                throw UsageError(fmt::format(
                    "{}: the field is no longer finite at step {}, {:.6g} s; dt is probably "
                    "unstable, or the absorbing layer, which a larger MultiAxialPMLRatio "
                    "stabilises",
                    arguments.input.string(), done, static_cast<double>(done) * grid.dt_s));
        if (!arguments.checkpoint.empty() && done < steps)
            stops = world.any(
                schedule::stop_requested() ||
                (arguments.checkpoint_steps > 0 && done - first >= arguments.checkpoint_steps) ||
                (arguments.checkpoint_interval_s > 0.0 &&
                 seconds_since(phases.began) >= arguments.checkpoint_interval_s));
        const long now = 100 * done / steps / arguments.progress_percent;
        if (now == reported && !stops) continue;
        reported = now;
        const double passed_s = seconds_since(phases.phase);
        print(world, fmt::format("{:4} %  step {} of {}, {:.1f} s passed, {:.1f} s to go",
                                 100 * done / steps, done, steps, passed_s,
                                 passed_s / static_cast<double>(done - first) *
                                     static_cast<double>(steps - done)));
    }
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
    const std::filesystem::path part = arguments.output.string() + ".part";
    const double memory_B = world.sum(pipeline::peak_memory_B());
    try {
        fail_together(world, [&] {
            OutputFile output{.doubles = arguments.output_precision == "double",
                              .gzip_level = arguments.gzip_level};
            h5::Id file;
            if (world.is_root()) {
                file = h5::open_file(part, h5::Access::create);
                output.file = file.raw();
            }
            write_records(output, *recorder, *input, stepper, world);
            if (!world.is_root()) return;
            write_facts(output, arguments, *input, steps, stepper.steps(), phases, world.size(),
                        memory_B);
            file.close("write " + part.string());
            storage::publish(part, arguments.output);
        });
    } catch (const Error&) {
        std::error_code ignored;
        if (world.is_root()) std::filesystem::remove(part, ignored);
        throw;
    }
    if (!stops && !arguments.checkpoint.empty() && world.is_root())
        std::filesystem::remove(arguments.checkpoint);
    print(world, stops ? fmt::format("stopped after step {}; repeat the command to resume from {}",
                                     stepper.steps(), arguments.checkpoint.string())
                       : fmt::format("{}: {:.1f} s, {:.3g} Mpoint/s", arguments.output.string(),
                                     seconds_since(phases.began),
                                     1e-6 * points * static_cast<double>(steps - first) /
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
        const bool is_older = std::filesystem::exists(arguments.output);
        throw UsageError(error.what() +
                             (is_older ? "; " + arguments.output.string() + " is of an earlier run"
                                       : std::string()),
                         ExitCode::internal);
    }
    return ExitCode::done;
}

} // namespace shearwake::kwave
