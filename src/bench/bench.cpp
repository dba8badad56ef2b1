// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench.hpp"

#include "base/json.hpp"
#include "base/text.hpp"
#include "engines/layered/layered_engine.hpp"
#include "engines/pstd/make_scheme.hpp"
#include "engines/pstd/scheme/stepper.hpp"
#include "engines/registry/make_engine.hpp"
#include "engines/spectral/stepping/stepper.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "fft/slab_transform.hpp"
#include "fft/staggered_derivative.hpp"
#include "parallel/agree.hpp"
#include "pipeline/compute.hpp"
#include "simd/instruction_set.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::bench {
namespace {

using Grid = std::vector<std::ptrdiff_t>;

constexpr int steps = 20; // that are timed

/// The time of a case or step with this number of points, and that of its FFTs alone.
Json measurement(const std::string& name, double s, std::ptrdiff_t count, double fft_s) {
    const auto points = static_cast<double>(count);
    return {{"name", name}, {"time_s", s}, {"points_per_s", points / s}, {"fft_s", fft_s}};
}

/// Wall-clock seconds of the slowest rank in the fastest of several repetitions, which is the least
/// disturbed by other processes.
double best_of(int times, const Comm& world, const auto& work) {
    double best = 1e300;
    for (int i = 0; i < times; ++i) {
        world.barrier();
        const auto began = Clock::now();
        work();
        best = std::min(best, world.max(seconds_since(began)));
    }
    return best;
}

/// Bytes per second that all ranks together read and write when all of them copy memory.
double copy_rate_B_s(const Comm& world) {
    fft::AlignedVector<double> from(std::size_t{1} << 24, 1.0), to(std::size_t{1} << 24);
    const double s = best_of(5, world, [&] { std::copy(from.begin(), from.end(), to.begin()); });
    return 2.0 * 8.0 * static_cast<double>(from.size()) / s * world.size();
}

/// Mean seconds of the forward and the backward FFT of a plane.
double plane_s(const fft::SlabTransform& slabs, const Comm& world) {
    fft::AlignedVector<double> plane(static_cast<std::size_t>(slabs.share().reals));
    return 0.5 * best_of(20, world, [&] {
               slabs.to_spectral(plane.data());
               slabs.to_physical(plane.data());
           });
}

/// A complete case with all measures, without its transfer functions, and the FFTs of its frames.
Json measure_case(const char* kind, const Case& c, const Comm& world) {
    const auto engine = engines::make_engine(c.solver);
    const PlannedCase planned{.id = {}, .physics = c, .settings = {}, .reference_id = {}};
    const auto plan = pipeline::plan_case(c, world.size(), *engine);
    const double time_s = best_of(6, world, [&] { // the first computes the transfer functions
        pipeline::compute(planned, plan, *engine, world, {});
    });
    const Domain solved = layered::solved_domain(c);
    const fft::SlabTransform slabs(solved.nx, solved.ny, world);
    return measurement(
        fmt::format("{} x {} x {} frames, {}", c.domain.nx, c.domain.ny, c.time.frames, kind),
        time_s, c.domain.nx * c.domain.ny * c.time.frames,
        plane_s(slabs, world) * static_cast<double>(c.time.frames));
}

Json measure_layered(const Comm& world) {
    Case c = layered_bench_case();
    Json all = Json::array({measure_case("periodic edges", c, world)});
    c.domain.edges = DomainEdges::open;
    all.push_back(measure_case("open edges", c, world));
    c.scene.load.modulation.trajectory = {{Travel{
        Arc{{}, 10e-3, 0.0, two_pi}, ConstantSpeed{two_pi * 10e-3 * 100.0}, AtEnd::repeat}}};
    c.time = {128, 10e-3 / 128.0, Regime::periodic};
    c.measure = {.at_s = c.time.duration_s(), .settled_after_s = 0.0, .focal_radius_m = 3e-3};
    all.push_back(measure_case("periodic regime", c, world));
    return all;
}

/// A focus of 3 mm that moves at 7 m/s over a layer with elements of 4 mm. The run has many frames,
/// since the matrices that speed up iterations are worth their cost only then.
Case spectral_case(const Grid& grid) {
    Case c = layered_bench_case();
    c.solver = SpectralOptions{.time_step_s = 50e-6, .longest_element_m = 4.04e-3};
    auto& layers = c.scene.medium.layers;
    layers = {layers.back()};
    layers[0].thickness_m = 4e-3 * static_cast<double>(grid[2] / 8);
    layers[0].c_s_m_s = 5.0;
    c.scene.load.modulation.trajectory = {
        {Travel{{{-5e-3, 0.0}, {300e-3, 0.0}}, ConstantSpeed{7.0}}}};
    c.scene.load.modulation.envelope = {};
    c.domain = {good_even_length(grid[0]), good_even_length(grid[1]), 0.75e-3, 0.0};
    c.time = {560, 50e-6};
    c.measure.at_s = c.time.duration_s();
    return c;
}

/// The mean time of the steps, whose number of iterations varies, and the FFTs of as many complete
/// planes as they transform.
Json measure_spectral(const Grid& grid, const Comm& world) {
    Case c = spectral_case(grid);
    // Elements need not end at the faces of bodies, since only the speed matters here.
    const auto mesh = spectral::choose_mesh(c, std::get<SpectralOptions>(c.solver));
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, world, fft::Planning::measured);
    const double depth_m = c.scene.medium.layers[0].thickness_m, fft_s = plane_s(slabs, world);
    Json all = Json::array();
    const auto measure_steps = [&](const std::string& kind) {
        spectral::Stepper stepper(c, mesh, slabs, c.time.interval_s, world);
        stepper.advance(); // the first step touches cold memory
        const std::ptrdiff_t before = stepper.statistics().transforms;
        const double steps_s = best_of(1, world, [&] {
            for (int n = 0; n < steps; ++n)
                stepper.advance();
        });
        const auto transforms = static_cast<double>(stepper.statistics().transforms - before);
        all.push_back(measurement(
            fmt::format("{} x {} x {} levels, {}", c.domain.nx, c.domain.ny, mesh.levels(), kind),
            steps_s / steps, c.domain.nx * c.domain.ny * static_cast<std::ptrdiff_t>(mesh.levels()),
            transforms / steps * fft_s));
    };
    measure_steps("no body");
    Body body{.shape = Ellipsoid{{12e-3, 8e-3, 0.25 * depth_m}},
              .centre_m = {0.0, 2e-3, 0.375 * depth_m}};
    for (const double contrast : {4.0, 16.0, 1000.0}) {
        body.c_s_m_s = 5.0 * std::sqrt(contrast);
        c.scene.medium.bodies = {body};
        measure_steps(fmt::format("contrast {:g}", contrast));
    }
    c.scene.medium.bodies = {{.shape = Cylinder{.radius_m = std::min(5e-3, 0.4 * depth_m)},
                              .centre_m = {0.0, 0.0, 0.5 * depth_m},
                              .density_kg_m3 = 1900.0,
                              .rigid = true}};
    measure_steps("rigid cylinder");
    return all;
}

/// A uniform solid with an absorbing layer of 10 points. Sources throughout the grid drive it with
/// pseudorandom values.
pstd::Setup pstd_setup(const Grid& grid, bool is_lossy) {
    pstd::Setup s;
    s.grid = {{grid[0], grid[1], grid[2]}, {1e-3, 1e-3, 1e-3}, 1e-6};
    s.absorption = is_lossy ? pstd::Absorption::kelvin_voigt : pstd::Absorption::none;
    s.material = [](pstd::Node) { return pstd::NodeMaterial{1000.0, 20.0, 5.0, 0.01, 0.01}; };
    pstd::Source source{.samples = 1};
    source.values = [](std::ptrdiff_t, std::span<const std::size_t> which, std::span<double> to) {
        for (std::size_t i = 0; i < which.size(); ++i)
            to[i] = std::sin(12.9898 * static_cast<double>(which[i]));
    };
    for (std::ptrdiff_t x = 0; x < grid[0]; x += 4)
        for (std::ptrdiff_t y = 0; y < grid[1]; y += 4)
            for (std::ptrdiff_t z = 0; z < grid[2]; z += 4)
                source.nodes.push_back({x, y, z});
    for (const pstd::Field field : {pstd::Field::ux, pstd::Field::uz, pstd::Field::sxy}) {
        source.field = field;
        s.sources.push_back(source);
    }
    return s;
}

/// The fastest step, and the forward and backward FFTs alone of all lines that it differentiates.
template <class Real>
Json measure_pstd(const Grid& grid, bool is_lossy, const Comm& world) {
    const pstd::Setup setup = pstd_setup(grid, is_lossy);
    pstd::Stepper<Real> stepper(setup, world);
    const double step_s = best_of(1 + steps, world, [&] { stepper.step(); });
    const std::ptrdiff_t points = grid[0] * grid[1] * grid[2];
    double fft_s = 0.0;
    for (const std::ptrdiff_t length : grid) {
        fft::StaggeredDerivative<Real> lines(length, 1e-3, world);
        const auto blocks = (is_lossy ? 9 : 6) * points / world.size() / (2 * lines.width * length);
        fft_s += best_of(5, world, [&] {
            for (std::ptrdiff_t i = 0; i < blocks; ++i)
                lines.transform_block();
        });
    }
    return measurement(fmt::format("{} x {} x {} points, {}, {}", grid[0], grid[1], grid[2],
                                   is_lossy ? "lossy" : "lossless",
                                   sizeof(Real) == 8 ? "double" : "single"),
                       step_s, points, fft_s);
}

/// The mean of some steps on a GPU, and the share of the bandwidth of its copies that they use.
Json measure_device(const Grid& grid, bool is_lossy, Precision precision, int number,
                    const Comm& world) {
    const auto scheme =
        pstd::make_scheme(pstd_setup(grid, is_lossy), precision, {PstdDevice::gpu, number}, world);
    const double steps_s = best_of(3, world, [&] { // the first compiles and loads the kernels
        for (int n = 0; n < steps; ++n)
            scheme->step();
        scheme->kinetic_J(); // waits for the steps
    });
    Json measured =
        measurement(fmt::format("{} x {} x {} points, {}, {}", grid[0], grid[1], grid[2],
                                is_lossy ? "lossy" : "lossless",
                                precision == Precision::double_precision ? "double" : "single"),
                    steps_s / steps, grid[0] * grid[1] * grid[2], 0.0);
    measured["device"] = scheme->device_name();
    measured["share_of_copies"] = scheme->copy_share(steps / steps_s);
    return measured;
}

} // namespace

Case layered_bench_case() {
    Case c;
    c.scene.medium = {{{"epidermis", 0.1e-3, 1000.0, 1500.0, 36.5, KelvinVoigt{1.0}},
                       {"dermis", 2e-3, 1000.0, 1500.0, 3.65, KelvinVoigt{1.0}},
                       {"fat", 18e-3, 1000.0, 1500.0, 2.24, KelvinVoigt{1.0}}},
                      Base::rigid};
    c.scene.load.peak_Pa = 100.0;
    c.scene.load.footprint = GaussianFootprint{3e-3};
    c.scene.load.modulation = {
        .kind = "AM-STM",
        .trajectory = {{Travel{{{-49e-3, 0.0}, {49e-3, 0.0}}, ConstantSpeed{7.0}}}},
        .envelope = {{SineGain{.frequency_Hz = 200.0}}}};
    c.domain = {256, 192, 0.75e-3, 0.0};
    c.time = {280, 50e-6};
    c.measure = {.at_s = 14e-3, .settled_after_s = 4e-3, .focal_radius_m = 3e-3};
    c.record = {.traces_m = {{0.0, 0.0}}};
    return c;
}

ExitCode bench_command(const BenchArguments& arguments, const Comm& world) {
    Json measured;
    double copies_B_s = 0.0;
    fail_together(world, [&] { // as in `run`, so that times include its agreements
        const auto& [engine, grid, device, gpu, json] = arguments;
        if (engine == "layered") measured = measure_layered(world);
        if (engine == "spectral")
            measured = measure_spectral(grid.empty() ? Grid{256, 192, 25} : grid, world);
        std::vector<Grid> grids = {{128, 96, 32}, {128, 128, 128}};
        if (!grid.empty()) grids = {grid};
        if (engine == "pstd")
            for (const Grid& points : grids)
                for (const bool is_lossy : {false, true}) {
                    if (device == "gpu") {
                        for (const auto p :
                             {Precision::double_precision, Precision::single_precision})
                            measured.push_back(measure_device(points, is_lossy, p, gpu, world));
                        continue;
                    }
                    measured.push_back(measure_pstd<double>(points, is_lossy, world));
                    measured.push_back(measure_pstd<float>(points, is_lossy, world));
                }
        copies_B_s = copy_rate_B_s(world);
    });
    if (!world.is_root()) return ExitCode::done;
    const std::string kernels(simd::name_of(simd::instruction_set()));
    if (arguments.json)
        fmt::print("{}", json_document("bench", {{"name", arguments.engine},
                                                 {"ranks", world.size()},
                                                 {"kernels", kernels},
                                                 {"copies_B_per_s", copies_B_s},
                                                 {"measurements", measured}}));
    if (arguments.json) return ExitCode::done;
    fmt::print("engine {}, {}, kernels {}, copies at {:.1f} GB/s\n{:>54} Mpoint/s  s of FFTs\n",
               arguments.engine, counted(world.size(), "rank"), kernels, 1e-9 * copies_B_s,
               arguments.engine == "layered" ? "s per case" : "s per step");
    for (const Json& m : measured)
        fmt::print("  {:<42}{:10.5f} {:8.4g} {}\n", m.at("name").get<std::string>(),
                   m.at("time_s").get<double>(), 1e-6 * m.at("points_per_s").get<double>(),
                   m.contains("device") ? fmt::format("{:.0f} % of copies on {}",
                                                      100.0 * m.at("share_of_copies").get<double>(),
                                                      m.at("device").get<std::string>())
                                        : fmt::format("{:10.5f}", m.at("fft_s").get<double>()));
    return ExitCode::done;
}

} // namespace shearwake::bench
