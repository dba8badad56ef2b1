#include "sweep/commands.hpp"

#include "engines/engine.hpp"
#include "fft/slab_transform.hpp"
#include "sweep/surface_recorder.hpp"

#include <chrono>
#include <fmt/format.h>

namespace shearwake {
namespace {

using Clock = std::chrono::steady_clock;

/// The slowest rank's seconds. Collective.
double seconds_of(const Comm& world, const auto& work) {
    world.barrier();
    const auto began = Clock::now();
    work();
    return world.max(std::chrono::duration<double>(Clock::now() - began).count());
}

/// Three layers of skin, a 3 mm focus at 7 m/s, 14 ms, 280 frames.
Case bench_case(const std::string& engine) {
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
    if (engine == "spectral") c.solver = SpectralOptions{.time_step_s = 50e-6};
    return c;
}

/// Best of a few: what the machine can do when nobody else uses it.
double best_of(int times, const auto& measure) {
    double best = measure();
    for (int i = 1; i < times; ++i)
        best = std::min(best, measure());
    return best;
}

} // namespace

ExitCode bench_command(const std::string& name, const Comm& world) {
    const Case c = bench_case(name);
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
    AlignedVector<double> from(std::size_t{1} << 24, 1.0), to(std::size_t{1} << 24);
    const double copy = best_of(5, [&] {
        return seconds_of(world, [&] { std::copy(from.begin(), from.end(), to.begin()); });
    });
    const double bandwidth = 2.0 * 8.0 * static_cast<double>(from.size()) / copy * world.size();

    if (!world.is_root()) return ExitCode::done;
    const double points = static_cast<double>(c.domain.nx * c.domain.ny * c.time.frames);
    fmt::print("engine {}, {} rank{}: {} x {} points, {} frames, three layers\n", name,
               world.size(), world.size() == 1 ? "" : "s", c.domain.nx, c.domain.ny, c.time.frames);
    if (name == "layered")
        fmt::print("  transfer function H        {:8.3f} s   once per medium and grid\n",
                   first - rest);
    else
        fmt::print("  a step of 50 us            {:8.4f} s   measures included\n",
                   rest / static_cast<double>(c.time.frames));
    fmt::print("  a case with all measures   {:8.3f} s   {:.2g} ns a point and frame\n", rest,
               1e9 * rest / points);
    fmt::print("  floor: its bare FFTW planes {:7.3f} s   the case takes {:.2f} times that\n",
               transforms, rest / transforms);
    fmt::print("  memory copies at           {:8.1f} GB/s\n", bandwidth / 1e9);
    return ExitCode::done;
}

} // namespace shearwake
