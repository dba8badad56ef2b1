// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "engines/spectral/spectral_plan.hpp"
#include "engines/spectral/stepping/stepper.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "pipeline/memory.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>

namespace shearwake::bench {
namespace {

constexpr double element_m = 4e-3;
constexpr int degree = 8;
/// Number of frames of the case, of which only some steps are computed. The matrices that speed up
/// iterations are worth their cost only in a long run, as they are in this one.
constexpr int frames = 560;

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
            "--grid {}: must be the points along x and y and the levels, for example 256x192x25: "
            "points must be even products of 2, 3, 5 and 7, at least 8; levels must be 9, 17, 25 "
            "... 321",
            text));
    return {nx, ny, levels};
}

/// A focus of 3 mm starts above an ellipsoid in the upper half of a layer, or above a rigid
/// cylinder of 5 mm radius that crosses the domain along x, and moves at 7 m/s. Elements are 4 mm
/// long.
Case bench_case(const BenchArguments& arguments) {
    const Grid grid = read_grid(arguments.grid.empty() ? "256x192x25" : arguments.grid);
    const double depth_m = element_m * static_cast<double>(grid.levels / degree);
    Case c;
    c.scene().medium = {{{.name = "tissue",
                          .thickness_m = depth_m,
                          .density_kg_m3 = 1000.0,
                          .c_p_m_s = 1500.0,
                          .c_s_m_s = 5.0,
                          .loss = KelvinVoigt{1.0}}},
                        Base::rigid};
    if (arguments.rigid)
        c.scene().medium.bodies = {{.name = "bone",
                                    .shape = Cylinder{.radius_m = std::min(5e-3, 0.4 * depth_m)},
                                    .centre_m = {0.0, 0.0, 0.5 * depth_m},
                                    .density_kg_m3 = 1900.0,
                                    .rigid = true}};
    else if (arguments.contrast > 1.0)
        c.scene().medium.bodies = {{.name = "body",
                                    .shape = Ellipsoid{{12e-3, 8e-3, 0.25 * depth_m}},
                                    .centre_m = {0.0, 2e-3, 0.375 * depth_m},
                                    .c_s_m_s = 5.0 * std::sqrt(arguments.contrast)}};
    c.scene().load.peak_Pa = 100.0;
    c.scene().load.footprint = GaussianFootprint{3e-3};
    c.scene().load.modulation = {
        .kind = "STM",
        .trajectory = {{Travel{{{-5e-3, 0.0}, {300e-3, 0.0}}, ConstantSpeed{7.0}}}},
        .envelope = {}};
    c.domain = {grid.nx, grid.ny, 0.75e-3, 1e-3 * arguments.sponge_mm};
    c.time = {frames, 50e-6}; // one frame of the surface per step
    c.measure = {.at_s = c.time.duration_s(), .settled_after_s = 0.0, .focal_radius_m = 3e-3};
    c.solver = SpectralOptions{
        .time_step_s = 50e-6, .degree = degree, .longest_element_m = 1.01 * element_m};
    return c;
}

/// Sums over all steps. Times are those of the slowest rank, times of phases are means over the
/// ranks.
struct Measured {
    double begin_s = 0.0, steps_s = 0.0, surface_s = 0.0;
    double uniform_s = 0.0;                   // the same number of steps without bodies
    double full_planes_s = 0.0, rows_s = 0.0; // the same number of FFTs alone, of planes or rows
    std::array<double, spectral::phase_count> phase_s{}, bytes{}; // bytes of all ranks
    spectral::StepStatistics statistics;
    std::ptrdiff_t planes = 0;
    double peak_memory_B = 0.0;
};

/// Measures steps and their lower bounds in turn, so that other processes slow both alike. One
/// bound is the forward and backward FFTs of the same number of complete planes in the same layout.
/// The other is the FFTs of only those rows that contain cells, which are all that a step
/// transforms.
void time_steps(std::ptrdiff_t steps, spectral::Stepper& stepper, spectral::Stepper* uniform,
                const fft::SlabTransform& slabs, const Comm& world, Measured& m) {
    fft::AlignedVector<double> bare(static_cast<std::size_t>(m.planes * slabs.share().reals));
    spectral::StepClock aside;
    spectral::StrainPlanes lines(stepper.field().cells(), slabs, world, aside, {});
    spectral::LateralField::Values values(stepper.field().size(), 0.0);
    if (m.planes > 0) lines.assemble();
    for (std::ptrdiff_t n = 0; n < steps; ++n) {
        m.steps_s += seconds_of(world, [&] { stepper.advance(); });
        if (uniform) m.uniform_s += seconds_of(world, [&] { uniform->advance(); });
        if (m.planes == 0) continue;
        m.full_planes_s += seconds_of(world, [&] {
            for (std::ptrdiff_t p = 0; p < m.planes; ++p)
                slabs.to_spectral(bare.data() + p * slabs.share().reals);
            for (std::ptrdiff_t p = 0; p < m.planes; ++p)
                slabs.to_physical(bare.data() + p * slabs.share().reals);
        });
        m.rows_s += seconds_of(world, [&] {
            lines.set(values);
            for (std::ptrdiff_t row = 0; row < slabs.share().ky_count; ++row) {
                lines.begin_row(row);
                lines.end_row(row, spectral::StrainPlanes::Modes::retained);
            }
            lines.get(values);
        });
    }
}

Measured measure(const Case& c, std::ptrdiff_t steps, const spectral::DepthMesh& mesh,
                 const fft::SlabTransform& slabs, const Comm& world) {
    Measured m;
    std::unique_ptr<spectral::Stepper> stepper;
    m.begin_s = seconds_of(world, [&] {
        stepper = std::make_unique<spectral::Stepper>(c, mesh, slabs, c.time.interval_s, world);
    });
    fft::AlignedVector<double> plane(static_cast<std::size_t>(slabs.share().reals));
    stepper->advance(); // the first step touches cold memory
    const spectral::StepClock before = stepper->clock();
    const spectral::StepStatistics first = stepper->statistics();
    m.planes = stepper->planes().count();
    m.peak_memory_B = world.max(pipeline::peak_memory_B());
    std::unique_ptr<spectral::Stepper> uniform;
    Case layers = c;
    if (!c.scene().medium.bodies.empty()) {
        layers.scene().medium.bodies.clear();
        uniform =
            std::make_unique<spectral::Stepper>(layers, mesh, slabs, c.time.interval_s, world);
        uniform->advance();
    }
    time_steps(steps, *stepper, uniform.get(), slabs, world, m);
    const spectral::StepClock& after = stepper->clock();
    for (std::size_t i = 0; i < spectral::phase_count; ++i) {
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
    const double times =
        static_cast<double>(m.statistics.transforms) / static_cast<double>(2 * m.planes * steps);
    m.full_planes_s *= times;
    m.rows_s *= times;
    return m;
}

void print(Output& out, const Measured& m, const Case& c, double levels, double copies_B_s,
           double planned_B) {
    constexpr std::array<const char*, spectral::phase_count> names = {
        "FFTs", "solves over depth", "strain/force transfer", "stresses, iteration", "sponge",
        "other"};
    const double steps = static_cast<double>(m.statistics.steps);
    const double step_s = m.steps_s / steps;
    const double points = static_cast<double>(c.domain.nx * c.domain.ny) * levels;
    double in_phases_s = 0.0, bytes = 0.0;
    for (std::size_t i = 0; i < spectral::phase_count; ++i) {
        in_phases_s += m.phase_s[i];
        bytes += m.bytes[i];
    }
    out.add("time per step", step_s, "s");
    out.add("frame of the surface", m.surface_s, "s");
    out.add("setup", m.begin_s, "s");
    out.add("peak memory per rank", m.peak_memory_B, "B");
    out.print("  time per step of {:g} us {:10.5f} s   {:.3g} million points per second\n",
              1e6 * c.time.interval_s, step_s, 1e-6 * points / step_s);
    if (m.uniform_s > 0.0) {
        out.add("uniform step", m.uniform_s / steps, "s");
        out.print("  uniform step           {:10.5f} s   without bodies, all wave vectors; a step "
                  "takes {:.2f} times as long\n",
                  m.uniform_s / steps, m.steps_s / m.uniform_s);
    }
    out.print("  iterations per step    {:10.2f}     {} planes of strain, {:.1f} transforms\n",
              static_cast<double>(m.statistics.iterations) / steps, m.planes,
              static_cast<double>(m.statistics.transforms) / steps);
    out.print("    {:<22} {:>8} {:>8} {:>10} {:>8}\n", "", "share", "s", "MB moved", "GB/s");
    const auto line = [&](const char* name, double seconds, double moved_B) {
        out.add(name, seconds / steps, "s");
        out.print("    {:<22} {:8.3f} {:8.5f} {:10.1f} {:8.1f}\n", name, seconds / in_phases_s,
                  seconds / steps, 1e-6 * moved_B / steps,
                  seconds > 0.0 ? 1e-9 * moved_B / seconds : 0.0);
    };
    for (std::size_t i = 0; i < spectral::phase_count; ++i)
        line(names[i], m.phase_s[i], m.bytes[i]);
    line("total", in_phases_s, bytes);
    const auto bound = [&](const char* name, double bound_s, const std::string& more) {
        out.add(fmt::format("lower bound: {}", name), bound_s / steps, "s");
        out.print("  lower bound: {:<14} {:10.5f} s   a step takes {:.2f} times as long{}\n", name,
                  bound_s / steps, m.steps_s / bound_s, more);
    };
    if (m.planes > 0) {
        bound("FFTs of planes", m.full_planes_s, "");
        bound("FFTs of rows", m.rows_s, "; only rows that contain cells");
    } else {
        out.print("  lower bound: {:<14} {:>10}     the medium does not vary laterally\n", "FFTs",
                  "none");
    }
    bound("memory traffic", bytes / copies_B_s,
          fmt::format("; copies at {:.1f} GB/s", 1e-9 * copies_B_s));
    out.print("  frame of the surface   {:10.5f} s   including its transform\n", m.surface_s);
    out.print("  setup                  {:10.3f} s   factorisations, materials\n", m.begin_s);
    out.print("  peak memory per rank   {:10.1f} MB  planned {:.1f} MB\n", 1e-6 * m.peak_memory_B,
              1e-6 * planned_B);
}

} // namespace

ExitCode bench_spectral(const BenchArguments& arguments, const Comm& world, Output& out) {
    const Case c = bench_case(arguments);
    // Without the body the mesh has exactly the requested levels. Elements need not end at the
    // body's faces, since only the speed matters here.
    Case layers = c;
    layers.scene().medium.bodies.clear();
    const spectral::DepthMesh mesh =
        spectral::choose_mesh(layers, std::get<SpectralOptions>(c.solver));
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, world, fft::Planning::measured);
    const Measured m = measure(c, arguments.steps, mesh, slabs, world);
    const double copies_B_s = copy_rate_B_s(world);
    const double planned_B = spectral::SpectralPlan(c, mesh, {.step_s = c.time.interval_s})
                                 .resources(world.size())
                                 .memory_per_rank_B();
    if (!world.is_root()) return ExitCode::done;
    const std::string body = arguments.rigid ? "a rigid cylinder"
                             : arguments.contrast > 1.0
                                 ? fmt::format("a body {:g} times stiffer", arguments.contrast)
                                 : "no body";
    const std::string sponge =
        arguments.sponge_mm > 0.0 ? fmt::format(", sponge of {:g} mm", arguments.sponge_mm) : "";
    out.print("engine spectral, {}: {} x {} points x {} levels, {} steps, {}{}\n",
              counted(world.size(), "rank"), c.domain.nx, c.domain.ny, mesh.levels(),
              m.statistics.steps, body, sponge);
    print(out, m, c, static_cast<double>(mesh.levels()), copies_B_s, planned_B);
    return ExitCode::done;
}

} // namespace shearwake::bench
