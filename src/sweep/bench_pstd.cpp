#include "sweep/bench.hpp"

#include "base/error.hpp"
#include "engines/pstd/stepper.hpp"
#include "fft/staggered_derivative.hpp"
#include "sweep/memory.hpp"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <fmt/format.h>
#include <malloc.h>

namespace shearwake {
namespace {

using namespace pstd;

Node read_points(const std::string& text) {
    int x = 0, y = 0, z = 0;
    char more = 0;
    if (std::sscanf(text.c_str(), "%dx%dx%d%c", &x, &y, &z, &more) != 3 || x < 2 || y < 2 ||
        z < 2 || x > 10000 || y > 10000 || z > 10000)
        throw UsageError(fmt::format("--grid {}: must be points along x, y and z, as 128x96x32: "
                                     "each from 2 to 10000, best products of 2, 3, 5 and 7",
                                     text));
    return {x, y, z};
}

/// A uniform solid that is in motion everywhere: numbers without a pattern, a layer of 10 points.
Setup bench_setup(const Node& points, Absorption absorption) {
    Setup s;
    s.grid = {points, {1e-3, 1e-3, 1e-3}, 1e-6};
    s.absorption = absorption;
    s.material = [](Node) { return NodeMaterial{1000.0, 20.0, 5.0, 0.01, 0.01}; };
    for (const Field field : {Field::ux, Field::uz, Field::sxy}) {
        Source source{.field = field, .samples = 1};
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

/// Seconds of the clock, and of a core: the same where nobody else uses the machine.
struct Seconds {
    double passed = 0.0, of_core = 0.0;
};

double core_s() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// The slowest rank's. Collective.
Seconds time_of(const Comm& world, const auto& work) {
    double cores_s = 0.0;
    const double passed_s = seconds_of(world, [&] {
        const double began_s = core_s();
        work();
        cores_s = core_s() - began_s;
    });
    return {passed_s, world.max(cores_s)};
}

/// Bytes that a rank reads and writes in a second of its core when all copy at once. Collective.
double copies_B_s(const Comm& world) {
    AlignedVector<double> from(std::size_t{1} << 23, 1.0), to(std::size_t{1} << 23);
    const double copy_s = best_of(10, [&] {
        return time_of(world, [&] { std::copy(from.begin(), from.end(), to.begin()); }).of_core;
    });
    return 2.0 * sizeof(double) * static_cast<double>(from.size()) / copy_s;
}

/// Of the points: how many keep the parts of their fields.
double share_in_layer(const Setup& setup) {
    double inside = 1.0;
    for (std::size_t a = 0; a < 3; ++a)
        inside *= static_cast<double>(
                      std::max<std::ptrdiff_t>(0, setup.grid.points[a] - 2 * setup.pml.points[a])) /
                  static_cast<double>(setup.grid.points[a]);
    return 1.0 - inside;
}

/// FFTW alone, there and back, for as many lines along each axis as a step derives.
template <class Real>
double bare_transforms_s(const Grid& grid, double derivatives_an_axis, const Comm& world) {
    const auto points =
        static_cast<double>(grid.points[0] * grid.points[1] * grid.points[2]) / world.size();
    double all_s = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
        StaggeredDerivative<Real> lines(grid.points[a], grid.spacing_m[a], world);
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

/// What a step must move at the least, in numbers a point: see PSTD's table of work; parts of
/// fields cost 39 of them where they are kept.
double least_touches(Absorption absorption, double in_layer) {
    return (absorption == Absorption::none ? 80.0 : 115.0) + 39.0 * in_layer;
}

template <class Real>
void measure(const Node& grid, Absorption absorption, int steps, double copied_B_s,
             const Comm& world) {
    const bool lossy = absorption == Absorption::kelvin_voigt;
    const Setup setup = bench_setup(grid, absorption);
    ::malloc_trim(0); // what is freed does not count
    const double before_B = world.sum(resident_memory_B());
    auto stepper = std::make_unique<Stepper<Real>>(setup, world);
    stepper->step(); // finds cold memory
    ::malloc_trim(0);
    const double memory_B = world.sum(resident_memory_B()) - before_B;
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
    fmt::print("  {:>4} x {:>3} x {:>3}  {:<8} {:<6} {:9.2f} {:9.2f} {:8.1f} {:8.2f} {:8.2f} "
               "{:6.2f} {:8.0f}\n",
               grid[0], grid[1], grid[2], lossy ? "lossy" : "lossless",
               sizeof(Real) == 8 ? "double" : "single", 1e3 * best.passed, 1e3 * best.of_core,
               1e9 * best.of_core * world.size() / points, 1e3 * fft_s, 1e3 * bytes_s,
               best.of_core / (fft_s + bytes_s), memory_B / points);
    std::fflush(stdout);
}

} // namespace

ExitCode bench_pstd(const BenchArguments& arguments, const Comm& world) {
    std::vector<Node> grids = {{128, 96, 32}, {128, 128, 128}};
    if (!arguments.grid.empty()) grids = {read_points(arguments.grid)};
    const double copied_B_s = copies_B_s(world);
    if (world.is_root()) {
        fmt::print("engine pstd, {} rank{}: a uniform solid, 10 points of layer on each side, {} "
                   "steps; a core copies {:.1f} GB/s\n",
                   world.size(), world.size() == 1 ? "" : "s", arguments.steps, copied_B_s / 1e9);
        fmt::print("  {:<16} {:<8} {:<6} {:>9} {:>9} {:>8} {:>8} {:>8} {:>6} {:>8}\n", "points", "",
                   "", "ms a step", "core ms", "core ns", "FFTs ms", "bytes ms", "ratio",
                   "B/point");
    }
    for (const Node& grid : grids) {
        for (const Absorption absorption : {Absorption::none, Absorption::kelvin_voigt}) {
            measure<double>(grid, absorption, arguments.steps, copied_B_s, world);
            measure<float>(grid, absorption, arguments.steps, copied_B_s, world);
        }
    }
    if (world.is_root())
        fmt::print(
            "  ms a step: the best one; core: the time that a core works, ns a point. ratio: "
            "core ms over\n  bare FFTs and the least bytes at the copies' rate\n");
    return ExitCode::done;
}

} // namespace shearwake
