// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "engines/pstd/scheme/stepper.hpp"
#include "fft/staggered_derivative.hpp"
#include "pipeline/memory.hpp"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <fmt/format.h>
#include <malloc.h>

namespace shearwake::bench {
namespace {

using namespace pstd;

pstd::Node read_points(const std::string& text) {
    int x = 0, y = 0, z = 0;
    char more = 0;
    if (std::sscanf(text.c_str(), "%dx%dx%d%c", &x, &y, &z, &more) != 3 || x < 2 || y < 2 ||
        z < 2 || x > 10000 || y > 10000 || z > 10000)
        throw UsageError(fmt::format("--grid {}: must be the points along x, y and z, for example "
                                     "128x96x32: each from 2 to 10000; products of 2, 3, 5 and 7 "
                                     "are fastest",
                                     text));
    return {x, y, z};
}

/// A uniform solid with an absorbing layer of 10 points. Sources throughout the grid drive it with
/// pseudorandom values.
pstd::Setup bench_setup(const pstd::Node& points, pstd::Absorption absorption) {
    pstd::Setup s;
    s.grid = {points, {1e-3, 1e-3, 1e-3}, 1e-6};
    s.absorption = absorption;
    s.material = [](pstd::Node) { return pstd::NodeMaterial{1000.0, 20.0, 5.0, 0.01, 0.01}; };
    for (const pstd::Field field : {pstd::Field::ux, pstd::Field::uz, pstd::Field::sxy}) {
        pstd::Source source{.field = field, .samples = 1};
        source.values = [](std::ptrdiff_t, std::span<const std::size_t> which,
                           std::span<double> values) {
            for (std::size_t i = 0; i < which.size(); ++i)
                values[i] = std::sin(12.9898 * static_cast<double>(which[i]));
        };
        for (std::ptrdiff_t x = 0; x < points[0]; x += 4)
            for (std::ptrdiff_t y = 0; y < points[1]; y += 4)
                for (std::ptrdiff_t z = 0; z < points[2]; z += 4)
                    source.nodes.push_back({x, y, z});
        s.sources.push_back(std::move(source));
    }
    return s;
}

/// Wall-clock and CPU seconds, which agree on an otherwise idle machine.
struct Seconds {
    double passed = 0.0, of_core = 0.0;
};

double core_s() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Seconds of the slowest rank. Collective.
Seconds time_of(const Comm& world, const auto& work) {
    double cores_s = 0.0;
    const double passed_s = seconds_of(world, [&] {
        const double began_s = core_s();
        work();
        cores_s = core_s() - began_s;
    });
    return {passed_s, world.max(cores_s)};
}

/// Bytes that a rank reads and writes per CPU second while all ranks copy memory. Collective.
double copies_B_s(const Comm& world) {
    fft::AlignedVector<double> from(std::size_t{1} << 23, 1.0), to(std::size_t{1} << 23);
    const double copy_s = best_of(10, [&] {
        return time_of(world, [&] { std::copy(from.begin(), from.end(), to.begin()); }).of_core;
    });
    return 2.0 * sizeof(double) * static_cast<double>(from.size()) / copy_s;
}

/// Share of the points in the absorbing layer, which store the split parts of their fields.
double share_in_layer(const pstd::Setup& setup) {
    double inside = 1.0;
    for (std::size_t a = 0; a < 3; ++a)
        inside *= static_cast<double>(
                      std::max<std::ptrdiff_t>(0, setup.grid.points[a] - 2 * setup.pml.points[a])) /
                  static_cast<double>(setup.grid.points[a]);
    return 1.0 - inside;
}

/// Seconds of the forward and backward FFTs alone, for the number of lines along each axis that a
/// step differentiates.
template <class Real>
double bare_transforms_s(const pstd::Grid& grid, double derivatives_an_axis, const Comm& world) {
    const auto points =
        static_cast<double>(grid.points[0] * grid.points[1] * grid.points[2]) / world.size();
    double all_s = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
        fft::StaggeredDerivative<Real> lines(grid.points[a], grid.spacing_m[a], world);
        const double in_a_block = static_cast<double>(2 * lines.width * grid.points[a]);
        const int blocks = std::max(1, static_cast<int>(1e6 / in_a_block));
        const auto transform = [&] {
            for (int i = 0; i < blocks; ++i)
                lines.transform_block();
        };
        const double block_s =
            best_of(10, [&] { return time_of(world, transform).of_core; }) / blocks;
        all_s += derivatives_an_axis * points / in_a_block * block_s;
    }
    return all_s;
}

/// Lower bound on the memory traffic of a step, in numbers per point: see the table of work in the
/// specification of the scheme. Split parts of fields add 39 numbers where they are stored.
double least_touches(pstd::Absorption absorption, double in_layer) {
    return (absorption == pstd::Absorption::none ? 80.0 : 115.0) + 39.0 * in_layer;
}

template <class Real>
void measure(const pstd::Node& grid, pstd::Absorption absorption, int steps, double copied_B_s,
             const Comm& world, Output& out) {
    const bool lossy = absorption == pstd::Absorption::kelvin_voigt;
    const pstd::Setup setup = bench_setup(grid, absorption);
    ::malloc_trim(0); // so that freed memory is not counted
    const double before_B = world.sum(pipeline::resident_memory_B());
    auto stepper = std::make_unique<pstd::Stepper<Real>>(setup, world);
    stepper->step(); // the first step touches cold memory
    ::malloc_trim(0);
    const double memory_B = world.sum(pipeline::resident_memory_B()) - before_B;
    Seconds best = time_of(world, [&] { stepper->step(); });
    for (int n = 1; n < steps; ++n) {
        const Seconds step = time_of(world, [&] { stepper->step(); });
        best = {std::min(best.passed, step.passed), std::min(best.of_core, step.of_core)};
    }
    const double points = static_cast<double>(grid[0] * grid[1] * grid[2]);
    const double fft_s = bare_transforms_s<Real>(setup.grid, lossy ? 9.0 : 6.0, world);
    const double bytes = static_cast<double>(sizeof(Real)) * points / world.size() *
                         least_touches(absorption, share_in_layer(setup));
    const double bytes_s = bytes / copied_B_s;
    if (!world.is_root()) return;
    const std::string name =
        fmt::format("{} x {} x {}, {}, {}", grid[0], grid[1], grid[2], lossy ? "lossy" : "lossless",
                    sizeof(Real) == 8 ? "double" : "single");
    out.add(name + ": time per step", best.passed, "s");
    out.add(name + ": CPU time per step and rank", best.of_core, "s");
    out.add(name + ": lower bound", fft_s + bytes_s, "s");
    out.add(name + ": memory per point", memory_B / points, "B");
    out.add(name + ": points per second", 1e-6 * points / best.passed, "Mpoint/s");
    out.add(name + ": share of the copy bandwidth", bytes_s / best.of_core, "1");
    out.print("  {:>4} x {:>3} x {:>3}  {:<8} {:<6} {:9.2f} {:9.2f} {:8.1f} {:8.2f} {:8.2f} "
              "{:6.2f} {:8.0f} {:9.2f} {:6.2f}\n",
              grid[0], grid[1], grid[2], lossy ? "lossy" : "lossless",
              sizeof(Real) == 8 ? "double" : "single", 1e3 * best.passed, 1e3 * best.of_core,
              1e9 * best.of_core * world.size() / points, 1e3 * fft_s, 1e3 * bytes_s,
              best.of_core / (fft_s + bytes_s), memory_B / points, 1e-6 * points / best.passed,
              bytes_s / best.of_core);
    std::fflush(stdout);
}

} // namespace

ExitCode bench_pstd(const BenchArguments& arguments, const Comm& world, Output& out) {
    std::vector<pstd::Node> grids = {{128, 96, 32}, {128, 128, 128}};
    if (!arguments.grid.empty()) grids = {read_points(arguments.grid)};
    const double copied_B_s = copies_B_s(world);
    if (world.is_root()) {
        out.print("engine pstd, {}: uniform solid, absorbing layer of 10 points on each "
                  "side, {} steps; each core copies {:.1f} GB/s\n",
                  counted(world.size(), "rank"), arguments.steps, copied_B_s / 1e9);
        out.print("  {:<16} {:<8} {:<6} {:>9} {:>9} {:>8} {:>8} {:>8} {:>6} {:>8} {:>9} {:>6}\n",
                  "points", "", "", "ms/step", "core ms", "ns/point", "FFTs ms", "bytes ms",
                  "ratio", "B/point", "Mpoint/s", "copies");
    }
    for (const pstd::Node& grid : grids) {
        for (const pstd::Absorption absorption :
             {pstd::Absorption::none, pstd::Absorption::kelvin_voigt}) {
            measure<double>(grid, absorption, arguments.steps, copied_B_s, world, out);
            measure<float>(grid, absorption, arguments.steps, copied_B_s, world, out);
        }
    }
    if (world.is_root())
        out.print("  ms/step: wall-clock time of the fastest step; core ms: CPU time per rank; "
                  "ns/point: CPU time of all\n  ranks per point; ratio: core ms over the lower "
                  "bound, which is the FFTs alone plus the least memory\n  traffic at the rate of "
                  "copies; copies: the least traffic per core ms as a share of this rate\n");
    return ExitCode::done;
}

} // namespace shearwake::bench
