#include "sweep/commands.hpp"

#include "engines/engine.hpp"
#include "fft/slab_transform.hpp"
#include "sweep/bench.hpp"
#include "sweep/surface_recorder.hpp"

#include <fmt/format.h>

namespace shearwake {
namespace {

ExitCode bench_layered(const Comm& world) {
    const Case c = layered_bench_case();
    const auto engine = make_engine(c.solver);
    const auto whole_case = [&] {
        SurfaceRecorder recorder(c, world, nullptr, {});
        return seconds_of(world, [&] {
            engine->run(c, world, recorder);
            recorder.finish();
        });
    };
    const double first = whole_case();
    const double rest = best_of(5, whole_case);

    const SlabTransform slabs(c.domain.nx, c.domain.ny, world);
    AlignedVector<double> plane(static_cast<std::size_t>(slabs.share().reals));
    const double transforms = best_of(5, [&] {
        return seconds_of(world, [&] {
            for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
                plane.assign(plane.size(), 0.0);
                slabs.to_physical(plane.data());
            }
        });
    });
    const double copies_B_s = copy_rate_B_s(world);

    if (!world.is_root()) return ExitCode::done;
    const double points = static_cast<double>(c.domain.nx * c.domain.ny * c.time.frames);
    fmt::print("engine layered, {} rank{}: {} x {} points, {} frames, three layers\n", world.size(),
               world.size() == 1 ? "" : "s", c.domain.nx, c.domain.ny, c.time.frames);
    fmt::print("  transfer function H        {:8.3f} s   once per medium and grid\n", first - rest);
    fmt::print("  a case with all measures   {:8.3f} s   {:.2g} ns a point and frame\n", rest,
               1e9 * rest / points);
    fmt::print("  floor: its bare FFTW planes {:7.3f} s   the case takes {:.2f} times that\n",
               transforms, rest / transforms);
    fmt::print("  memory copies at           {:8.1f} GB/s\n", copies_B_s / 1e9);
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
    c.medium = {
        {layer("epidermis", 0.1e-3, 36.5), layer("dermis", 2e-3, 3.65), layer("fat", 18e-3, 2.24)},
        Base::rigid};
    c.load.peak_Pa = 100.0;
    c.load.footprint = GaussianFootprint{3e-3};
    c.load.modulation = {
        .kind = "AM-STM",
        .trajectory = {{Travel{{{-49e-3, 0.0}, {49e-3, 0.0}}, ConstantSpeed{7.0}}}},
        .envelope = {{SineGain{.frequency_Hz = 200.0}}}};
    c.domain = {256, 192, 0.75e-3, 0.0};
    c.time = {280, 50e-6};
    c.measure = {.at_s = 14e-3, .settled_after_s = 4e-3, .focal_radius_m = 3e-3};
    c.record = {.traces_m = {{0.0, 0.0}}};
    return c;
}

double copy_rate_B_s(const Comm& world) {
    AlignedVector<double> from(std::size_t{1} << 24, 1.0), to(std::size_t{1} << 24);
    const double copy = best_of(5, [&] {
        return seconds_of(world, [&] { std::copy(from.begin(), from.end(), to.begin()); });
    });
    return 2.0 * 8.0 * static_cast<double>(from.size()) / copy * world.size();
}

ExitCode bench_command(const BenchArguments& arguments, const Comm& world) {
    if (arguments.engine == "neural") return bench_neural(world);
    if (arguments.engine == "spectral") return bench_spectral(arguments, world);
    if (arguments.engine == "pstd") return bench_pstd(arguments, world);
    if (arguments.engine == "sweep") return bench_sweep(arguments.cases, world);
    if (arguments.engine == "machine") return bench_machine(world);
    return bench_layered(world);
}

} // namespace shearwake
