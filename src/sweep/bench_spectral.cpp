#include "sweep/bench.hpp"

#include "base/error.hpp"
#include "engines/spectral/spectral_estimate.hpp"
#include "engines/spectral/stepper.hpp"
#include "sweep/memory.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>

namespace shearwake {
namespace {

constexpr double element_m = 4e-3;
constexpr int degree = 8;

struct Grid {
    std::ptrdiff_t nx, ny, levels;
};

Grid read_grid(const std::string& text) {
    int nx = 0, ny = 0, levels = 0;
    char more = 0;
    if (std::sscanf(text.c_str(), "%dx%dx%d%c", &nx, &ny, &levels, &more) != 3 || nx < 8 ||
        ny < 8 || nx > 100000 || ny > 100000 || nx != good_even_length(nx) ||
        ny != good_even_length(ny) || levels <= degree || levels > 321 || levels % degree != 1)
        throw UsageError(fmt::format(
            "--grid {}: must be points along x and y and levels, as 256x192x25: even products of "
            "2, 3, 5 and 7 from 8 on; 9, 17, 25 ... 321 levels",
            text));
    return {nx, ny, levels};
}

/// A 3 mm focus at 7 m/s that begins above a body in the upper half of a layer, 4 mm an element.
Case bench_case(const BenchArguments& arguments) {
    const Grid grid = read_grid(arguments.grid.empty() ? "256x192x25" : arguments.grid);
    const double depth_m = element_m * static_cast<double>(grid.levels / degree);
    Case c;
    c.medium = {{{.name = "tissue",
                  .thickness_m = depth_m,
                  .density_kg_m3 = 1000.0,
                  .c_p_m_s = 1500.0,
                  .c_s_m_s = 5.0,
                  .loss = KelvinVoigt{1.0}}},
                Base::rigid};
    if (arguments.contrast > 1.0)
        c.medium.bodies = {{.name = "body",
                            .shape = Ellipsoid{{12e-3, 8e-3, 0.25 * depth_m}},
                            .centre_m = {0.0, 2e-3, 0.375 * depth_m},
                            .c_s_m_s = 5.0 * std::sqrt(arguments.contrast)}};
    c.load.peak_Pa = 100.0;
    c.load.footprint = GaussianFootprint{3e-3};
    c.load.modulation = {
        .kind = "STM",
        .trajectory = {{Travel{{{-5e-3, 0.0}, {300e-3, 0.0}}, ConstantSpeed{7.0}}}},
        .envelope = {}};
    c.domain = {grid.nx, grid.ny, 0.75e-3, 1e-3 * arguments.sponge_mm};
    c.time = {arguments.steps, 50e-6}; // a surface every step
    c.measure = {.at_s = c.time.duration_s(), .settled_after_s = 0.0, .focal_radius_m = 3e-3};
    c.solver = SpectralOptions{
        .time_step_s = 50e-6, .degree = degree, .longest_element_m = 1.01 * element_m};
    return c;
}

/// Of all steps; seconds are the slowest rank's, of each phase the mean over the ranks.
struct Measured {
    double begin_s = 0.0, steps_s = 0.0, surface_s = 0.0;
    double whole_planes_s = 0.0, rows_s = 0.0; // as many bare transforms, of planes or of rows
    std::array<double, phase_count> phase_s{}, bytes{}; // bytes of all ranks
    StepStatistics statistics;
    std::ptrdiff_t planes = 0;
    double peak_memory_B = 0.0;
};

Measured measure(const Case& c, const DepthMesh& mesh, const SlabTransform& slabs,
                 const Comm& world) {
    Measured m;
    std::unique_ptr<Stepper> stepper;
    m.begin_s = seconds_of(world, [&] {
        stepper = std::make_unique<Stepper>(c, mesh, slabs, c.time.interval_s, world);
    });
    AlignedVector<double> plane(static_cast<std::size_t>(slabs.share().reals));
    stepper->advance(); // the first one finds cold memory
    const StepClock before = stepper->clock();
    const StepStatistics first = stepper->statistics();
    m.planes = stepper->planes().count();
    m.peak_memory_B = world.max(peak_memory_B());
    // The floors between the steps: whoever else uses the machine slows all. Bare transforms, there
    // and back, of as many whole planes in the same layout; and of their rows with cells alone, all
    // that a step transforms.
    AlignedVector<double> bare(static_cast<std::size_t>(m.planes * slabs.share().reals));
    StepClock aside;
    StrainPlanes lines(stepper->field(), slabs, world, aside);
    LateralField::Values values(stepper->field().size(), 0.0);
    if (m.planes > 0) lines.assemble();
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
        m.steps_s += seconds_of(world, [&] { stepper->advance(); });
        if (m.planes == 0) continue;
        m.whole_planes_s += seconds_of(world, [&] {
            for (std::ptrdiff_t p = 0; p < m.planes; ++p)
                slabs.to_spectral(bare.data() + p * slabs.share().reals);
            for (std::ptrdiff_t p = 0; p < m.planes; ++p)
                slabs.to_physical(bare.data() + p * slabs.share().reals);
        });
        m.rows_s += seconds_of(world, [&] {
            lines.set(values);
            for (std::ptrdiff_t row = 0; row < slabs.share().ky_count; ++row) {
                lines.begin_row(row);
                lines.end_row(row, false);
            }
            lines.get(values);
        });
    }
    const StepClock& after = stepper->clock();
    for (std::size_t i = 0; i < phase_count; ++i) {
        m.phase_s[i] = (after.seconds(i) - before.seconds(i)) / world.size();
        m.bytes[i] = after.bytes(i) - before.bytes(i);
    }
    world.sum(std::span<double>(m.phase_s));
    world.sum(std::span<double>(m.bytes));
    m.surface_s = seconds_of(world, [&] {
        stepper->plane_of_w(0.0, plane.data());
        slabs.to_physical(plane.data());
    });
    m.statistics = stepper->statistics();
    m.statistics.steps -= first.steps;
    m.statistics.iterations -= first.iterations;
    m.statistics.transforms -= first.transforms;
    if (m.planes == 0) return m;
    const double times = static_cast<double>(m.statistics.transforms) /
                         static_cast<double>(2 * m.planes * c.time.frames);
    m.whole_planes_s *= times;
    m.rows_s *= times;
    return m;
}

void print(const Measured& m, const Case& c, double levels, double copies_B_s,
           const Estimate& estimate, int ranks) {
    constexpr std::array<const char*, phase_count> names = {
        "FFTs", "solves over depth", "strain/force transfer", "stresses, iteration", "sponge",
        "other"};
    const double steps = static_cast<double>(m.statistics.steps);
    const double step_s = m.steps_s / steps;
    const double points = static_cast<double>(c.domain.nx * c.domain.ny) * levels;
    double in_phases_s = 0.0, bytes = 0.0;
    for (std::size_t i = 0; i < phase_count; ++i) {
        in_phases_s += m.phase_s[i];
        bytes += m.bytes[i];
    }
    fmt::print("  a step of {:g} us        {:10.5f} s   {:.3g} million points a second\n",
               1e6 * c.time.interval_s, step_s, 1e-6 * points / step_s);
    fmt::print("  iterations a step      {:10.2f}     {} planes of strain, {:.1f} transforms\n",
               static_cast<double>(m.statistics.iterations) / steps, m.planes,
               static_cast<double>(m.statistics.transforms) / steps);
    fmt::print("    {:<22} {:>8} {:>8} {:>10} {:>8}\n", "", "share", "s", "MB moved", "GB/s");
    const auto line = [&](const char* name, double seconds, double moved_B) {
        fmt::print("    {:<22} {:8.3f} {:8.5f} {:10.1f} {:8.1f}\n", name, seconds / in_phases_s,
                   seconds / steps, 1e-6 * moved_B / steps,
                   seconds > 0.0 ? 1e-9 * moved_B / seconds : 0.0);
    };
    for (std::size_t i = 0; i < phase_count; ++i)
        line(names[i], m.phase_s[i], m.bytes[i]);
    line("together", in_phases_s, bytes);
    const auto floor = [&](const char* name, double floor_s, const std::string& more) {
        fmt::print("  floor: {:<15} {:10.5f} s   a step takes {:.2f} times that{}\n", name,
                   floor_s / steps, m.steps_s / floor_s, more);
    };
    if (m.planes > 0) {
        floor("bare FFTs", m.whole_planes_s, "");
        floor("their rows", m.rows_s, ": FFTs of rows with cells alone");
    } else {
        fmt::print("  floor: bare FFTs             none     nothing varies laterally\n");
    }
    floor("memory", bytes / copies_B_s, fmt::format("; copies at {:.1f} GB/s", 1e-9 * copies_B_s));
    fmt::print("  a surface              {:10.5f} s   its transform included\n", m.surface_s);
    fmt::print("  to begin               {:10.3f} s   factors, materials\n", m.begin_s);
    fmt::print(
        "  estimated              {:10.5f} s   a step with its surface, to begin shared out\n",
        estimate.seconds / ranks / static_cast<double>(c.time.frames));
    fmt::print("  memory of a rank       {:10.1f} MB  at most; estimated {:.1f} MB\n",
               1e-6 * m.peak_memory_B, 1e-6 * estimate.memory_per_rank_B);
}

} // namespace

ExitCode bench_spectral(const BenchArguments& arguments, const Comm& world) {
    const Case c = bench_case(arguments);
    // As many levels as asked for, wherever the body lies: this is about speed alone.
    Case layers = c;
    layers.medium.bodies.clear();
    const DepthMesh mesh = choose_mesh(layers, std::get<SpectralOptions>(c.solver));
    const SlabTransform slabs(c.domain.nx, c.domain.ny, world, Planning::measured);
    const Measured m = measure(c, mesh, slabs, world);
    const double copies_B_s = copy_rate_B_s(world);
    const Estimate estimate = estimate_spectral(c, mesh, 1, world.size());
    if (!world.is_root()) return ExitCode::done;
    const std::string body = arguments.contrast > 1.0
                                 ? fmt::format("a body {:g} times stiffer", arguments.contrast)
                                 : "no body";
    const std::string sponge =
        arguments.sponge_mm > 0.0 ? fmt::format(", {:g} mm of sponge", arguments.sponge_mm) : "";
    fmt::print("engine spectral, {} rank{}: {} x {} points x {} levels, {} steps, {}{}\n",
               world.size(), world.size() == 1 ? "" : "s", c.domain.nx, c.domain.ny, mesh.levels(),
               m.statistics.steps, body, sponge);
    print(m, c, static_cast<double>(mesh.levels()), copies_B_s, estimate, world.size());
    return ExitCode::done;
}

} // namespace shearwake
