// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.hpp"

#include "base/json.hpp"
#include "base/text.hpp"
#include "engines/engine.hpp"
#include "engines/layered/layered_engine.hpp"
#include "engines/registry/make_engine.hpp"
#include "fft/line_transform.hpp"
#include "fft/slab_transform.hpp"
#include "parallel/agree.hpp"
#include "pipeline/surface_recorder.hpp"
#include "simd/instruction_set.hpp"

#include <nlohmann/json.hpp>

namespace shearwake::bench {
namespace {

/// Seconds of the FFTs of `count` lines.
double lines_s(std::ptrdiff_t count, std::ptrdiff_t length, const Comm& world) {
    if (count == 0) return 0.0;
    const fft::LineTransform in_time(length, fft::Direction::backward);
    fft::AlignedVector<std::complex<double>> line(static_cast<std::size_t>(length));
    return best_of(3, [&] {
        return seconds_of(world, [&] {
            for (std::ptrdiff_t n = 0; n < count; ++n)
                in_time.execute(line.data());
        });
    });
}

/// Measures a case and the FFTs that it consists of; `name` begins the names of its measurements.
void measure_layered(const Case& c, const std::string& title, const std::string& name,
                     const Comm& world, Output& out) {
    const auto engine = engines::make_engine(c.solver);
    const auto complete_case = [&] {
        pipeline::SurfaceRecorder recorder(c, world, nullptr, {});
        return seconds_of(world, [&] {
            engine->run(c, world, recorder);
            recorder.finish();
        });
    };
    const double first = complete_case();
    const double rest = best_of(5, complete_case);

    const Domain solved = layered::solved_domain(c);
    const fft::SlabTransform slabs(solved.nx, solved.ny, world);
    fft::AlignedVector<double> plane(static_cast<std::size_t>(slabs.share().reals));
    const double transforms = best_of(5, [&] {
        return seconds_of(world, [&] {
            for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
                plane.assign(plane.size(), 0.0);
                slabs.to_physical(plane.data());
            }
        });
    });
    const layered::TimeLines lines = layered::time_lines(c, slabs.share());
    const double in_time_s = lines_s(lines.count, lines.length, world) +
                             lines_s(lines.of_load, lines.load_length, world);

    if (!world.is_root()) return;
    const double points = static_cast<double>(c.domain.nx * c.domain.ny * c.time.frames);
    const double all_s = transforms + in_time_s;
    out.print("{}: {} x {} points, {} frames\n", title, c.domain.nx, c.domain.ny, c.time.frames);
    out.print("  transfer functions         {:8.3f} s   once per medium and grid\n", first - rest);
    out.print("  case with all measures     {:8.3f} s   {:.2g} ns per point and frame\n", rest,
              1e9 * rest / points);
    out.print("  lower bound: all FFTs      {:8.3f} s   the case takes {:.2f} times as long: {} "
              "planes of {} x {} points, {} lines of {} samples in time, and {} of {} samples of "
              "the load\n",
              all_s, rest / all_s, c.time.frames, solved.nx, solved.ny, lines.count, lines.length,
              lines.of_load, lines.load_length);
    out.print("  FFTs of the planes         {:8.3f} s   the case takes {:.2f} times as long\n",
              transforms, rest / transforms);
    out.add(name + "transfer function", first - rest, "s");
    out.add(name + "case with all measures", rest, "s");
    out.add(name + "lower bound: all FFTs", all_s, "s");
    out.add(name + "FFTs of the planes", transforms, "s");
}

ExitCode bench_layered(const Comm& world, Output& out) {
    if (world.is_root())
        out.print("engine layered, {}: three layers, kernels {}\n", counted(world.size(), "rank"),
                  simd::name_of(simd::instruction_set()));
    measure_layered(layered_bench_case(), "periodic edges", "", world, out);
    Case open = layered_bench_case();
    open.domain.edges = DomainEdges::open;
    measure_layered(open, "open edges", "open edges: ", world, out);
    measure_layered(steady_bench_case(), "open edges, periodic regime", "periodic regime: ", world,
                    out);
    const double copies_B_s = copy_rate_B_s(world);
    if (!world.is_root()) return ExitCode::done;
    out.print("memory copies                {:8.1f} GB/s\n", copies_B_s / 1e9);
    out.add("memory copies", copies_B_s, "B/s");
    return ExitCode::done;
}

} // namespace

/// 256 x 192 points, a 3 mm focus, 14 ms in 280 frames.
Case layered_bench_case() {
    Case c;
    const auto layer = [](const char* name, double thickness_m, double c_s_m_s) {
        return Layer{.name = name,
                     .thickness_m = thickness_m,
                     .density_kg_m3 = 1000.0,
                     .c_p_m_s = 1500.0,
                     .c_s_m_s = c_s_m_s,
                     .loss = KelvinVoigt{1.0}};
    };
    c.scene().medium = {
        {layer("epidermis", 0.1e-3, 36.5), layer("dermis", 2e-3, 3.65), layer("fat", 18e-3, 2.24)},
        Base::rigid};
    c.scene().load.peak_Pa = 100.0;
    c.scene().load.footprint = GaussianFootprint{3e-3};
    c.scene().load.modulation = {
        .kind = "AM-STM",
        .trajectory = {{Travel{{{-49e-3, 0.0}, {49e-3, 0.0}}, ConstantSpeed{7.0}}}},
        .envelope = {{SineGain{.frequency_Hz = 200.0}}}};
    c.domain = {256, 192, 0.75e-3, 0.0};
    c.time = {280, 50e-6};
    c.measure = {.at_s = 14e-3, .settled_after_s = 4e-3, .focal_radius_m = 3e-3};
    c.record = {.traces_m = {{0.0, 0.0}}};
    return c;
}

/// 256 x 192 points, a circle of 20 mm and 128 frames of a period of 10 ms.
Case steady_bench_case() {
    Case c = layered_bench_case();
    c.scene().load.modulation.trajectory = {{Travel{
        Arc{{}, 10e-3, 0.0, two_pi}, ConstantSpeed{two_pi * 10e-3 * 100.0}, AtEnd::repeat}}};
    c.domain.edges = DomainEdges::open;
    c.time = {128, 10e-3 / 128.0, Regime::periodic};
    c.measure.at_s = c.time.duration_s();
    c.measure.settled_after_s = 0.0;
    return c;
}

double copy_rate_B_s(const Comm& world) {
    fft::AlignedVector<double> from(std::size_t{1} << 24, 1.0), to(std::size_t{1} << 24);
    const double copy = best_of(5, [&] {
        return seconds_of(world, [&] { std::copy(from.begin(), from.end(), to.begin()); });
    });
    return 2.0 * 8.0 * static_cast<double>(from.size()) / copy * world.size();
}

namespace {

ExitCode run_bench(const BenchArguments& arguments, const Comm& world, Output& out) {
    if (arguments.engine == "spectral") return bench_spectral(arguments, world, out);
    if (arguments.engine == "pstd") return bench_pstd(arguments, world, out);
    return bench_layered(world, out);
}

} // namespace

ExitCode bench_command(const BenchArguments& arguments, const Comm& world) {
    Output out(arguments.json ? Output::Form::document : Output::Form::text);
    ExitCode code = ExitCode::done;
    // As in `run`, so that the times include the agreement before each collective call.
    fail_together(world, [&] { code = run_bench(arguments, world, out); });
    if (!arguments.json || !world.is_root()) return code;
    nlohmann::ordered_json measurements = nlohmann::ordered_json::array();
    for (const Measurement& m : out.measurements())
        measurements.push_back({{"name", m.name}, {"value", m.value}, {"unit", m.unit}});
    fmt::print("{}", json_document("bench", {{"name", arguments.engine},
                                             {"ranks", world.size()},
                                             {"kernels", simd::name_of(simd::instruction_set())},
                                             {"measurements", measurements}}));
    return code;
}

} // namespace shearwake::bench
