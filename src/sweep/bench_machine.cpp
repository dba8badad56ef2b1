#include "sweep/bench.hpp"

#include "base/error.hpp"
#include "engines/engine.hpp"
#include "io/case_file_writer.hpp"
#include "io/case_index.hpp"
#include "io/files.hpp"
#include "io/journal.hpp"
#include "parallel/agree.hpp"
#include "sweep/machine.hpp"
#include "sweep/surface_recorder.hpp"

#include <complex>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>
#include <vector>

namespace shearwake {
namespace {

namespace fs = std::filesystem;

/// Seconds of a case over what its engine expects, each rank by itself and all at the same time, as
/// they share a machine's memory.
double factor_of(const Case& c, const Comm& world) {
    const Comm alone = world.split(world.rank());
    const auto engine = make_engine(c.solver);
    const auto run = [&] {
        SurfaceRecorder recorder(c, alone, nullptr, {});
        return seconds_of(world, [&] {
            engine->run(c, alone, recorder);
            recorder.finish();
        });
    };
    run(); // plans, and what is shared between cases
    return best_of(3, run) / engine->estimate(c, 1).seconds;
}

Case spectral_case() {
    Case c = layered_bench_case();
    c.domain = {128, 96, 1.5e-3, 0.0};
    c.time.frames = 60;
    c.measure.at_s = c.time.duration_s();
    c.measure.settled_after_s = 0.0;
    c.medium.bodies.push_back({.name = "body",
                               .shape = Ellipsoid{{2e-2, 2e-2, 2e-3}},
                               .centre_m = {0.0, 0.0, 6e-3},
                               .c_s_m_s = 6.0});
    c.solver = SpectralOptions{.time_step_s = c.time.interval_s};
    return c;
}

/// An all-to-all in which each rank sends so many numbers to each other.
double all_to_all_s(const Comm& world, int numbers) {
    const auto ranks = static_cast<std::size_t>(world.size());
    const std::vector<int> counts(ranks, numbers);
    const std::vector<std::complex<double>> sent(ranks * static_cast<std::size_t>(numbers));
    std::vector<std::complex<double>> received(sent.size());
    constexpr int times = 20;
    return best_of(3,
                   [&] {
                       return seconds_of(world, [&] {
                           for (int i = 0; i < times; ++i)
                               world.all_to_all(sent.data(), counts, received.data(), counts);
                       });
                   }) /
           times;
}

void measure_transposes(const Comm& world, Machine& machine) {
    if (world.size() == 1) return;
    const int many = std::max(1, (1 << 16) / world.size()); // 1 MiB a rank
    const double few_s = all_to_all_s(world, 1), many_s = all_to_all_s(world, many);
    machine.message_s = few_s / world.size();
    const double sent_B = 16.0 * many * world.size();
    machine.transposed_B_s = sent_B / std::max(many_s - few_s, 1e-9);
}

/// What a case costs beside its solve, and what is written in a second, in the folder where the
/// program runs. On rank 0.
void measure_files(const Comm& alone, Machine& machine) {
    const fs::path folder = fmt::format("shearwake-bench-{}", ::getpid());
    make_directory(folder / "cases");
    const Journal journal(folder / journal_name(""));
    int number = 0;
    constexpr int times = 10;
    const double each_s =
        best_of(2,
                [&] {
                    return seconds_of(alone, [&] {
                        for (int i = 0; i < times; ++i) {
                            const std::string id = std::to_string(number++);
                            const fs::path file = folder / "cases" / (id + ".h5");
                            std::vector<Variable> scalars;
                            for (int v = 0; v < 40; ++v)
                                scalars.push_back({.name = fmt::format("scalar_{}", v),
                                                   .dimensions = {},
                                                   .values = {1.0},
                                                   .units = "1",
                                                   .long_name = "a scalar",
                                                   .note = ""});
                            journal.started(id, 1);
                            CaseFileWriter(file, alone, {})
                                .commit({{"", scalars}}, {{"case_id", id},
                                                          {"title", id},
                                                          {"status", std::string("complete")}});
                            journal.finished(id, {});
                            add_to_index(folder / index_name(journal_name("")), file);
                        }
                    });
                }) /
        times;
    const std::string block(std::size_t{1} << 26, 'x');
    const double written_s =
        best_of(2, [&] { return seconds_of(alone, [&] { write_file(folder / "block", block); }); });
    fs::remove_all(folder);
    machine.file_s = each_s;
    machine.written_B_s = static_cast<double>(block.size()) / written_s;
}

} // namespace

ExitCode bench_machine(const Comm& world) {
    Machine machine;
    Case layered = layered_bench_case();
    layered.time.frames = 80;
    layered.measure.at_s = layered.time.duration_s();
    layered.measure.settled_after_s = 0.0;
    machine.layered_factor = factor_of(layered, world);
    machine.spectral_factor = factor_of(spectral_case(), world);
    measure_transposes(world, machine);
    const Comm alone = world.split(world.rank());
    on_root(world, [&] { measure_files(alone, machine); });
    machine.measured = fmt::format("on {}, {} rank{}, {}", host_name(), world.size(),
                                   world.size() == 1 ? "" : "s", timestamp());
    const auto file = machine_file();
    on_root(world, [&] {
        if (file) write_machine(machine, *file);
    });
    if (!world.is_root()) return ExitCode::done;
    fmt::print("{}\n", machine.measured);
    fmt::print("  a case of layered, spectral  {:8.2f} {:8.2f}  times what the engine expects\n",
               machine.layered_factor, machine.spectral_factor);
    fmt::print("  an all-to-all      {:10.2g} s for each partner, {:.2g} GB/s from each rank{}\n",
               machine.message_s, machine.transposed_B_s / 1e9,
               world.size() == 1 ? " (assumed: there is one rank)" : "");
    fmt::print("  a case beside its solve  {:10.4f} s for files here\n", machine.file_s);
    fmt::print("  written            {:10.2g} GB/s here\n", machine.written_B_s / 1e9);
    if (file)
        fmt::print("kept for plan and run: {}\n", file->string());
    else
        fmt::print("not kept: SHEARWAKE_CACHE is off, or there is no home\n");
    return ExitCode::done;
}

} // namespace shearwake
