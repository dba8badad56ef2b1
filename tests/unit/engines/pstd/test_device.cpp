// SPDX-License-Identifier: BSD-3-Clause
// The scheme on a GPU, or on the processor through OpenCL (pocl), against the Stepper.
#include "base/error.hpp"
#include "engines/pstd/make_scheme.hpp"
#include "engines/pstd/pstd_engine.hpp"
#include "engines/pstd/scheme/recorder.hpp"
#include "engines/pstd/scheme/stepper.hpp"
#include "support/memory_state.hpp"
#include "support/stop_at.hpp"
#include "support/volume_store.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

namespace test_pstd_device {

using namespace shearwake;
using namespace shearwake::pstd;

/// A source with random values at random nodes.
static Source random_source(const Grid& grid, pstd::Field field, SourceMode mode,
                            std::mt19937& random) {
    Source s{.field = field, .mode = mode, .samples = 25};
    for (std::ptrdiff_t x = 0; x < grid.points[0]; ++x)
        for (std::ptrdiff_t y = 0; y < grid.points[1]; ++y)
            for (std::ptrdiff_t z = 0; z < grid.points[2]; ++z)
                if (random() % 23 == 0) s.nodes.push_back({x, y, z});
    // Some nodes receive nothing in some samples.
    s.values = [](std::ptrdiff_t sample, std::span<const std::size_t> which,
                  std::span<double> values) {
        for (std::size_t i = 0; i < which.size(); ++i) {
            const double at = static_cast<double>(which[i]) + 0.37 * static_cast<double>(sample);
            values[i] = which[i] % 7 == 3 && sample % 2 == 1 ? std::nan("") : std::sin(7.0 * at);
        }
    };
    return s;
}

/// Fluid, empty nodes and a random solid, with layers along some axes, and sources of each kind in
/// and outside of the layers.
static Setup random_setup(std::array<std::ptrdiff_t, 3> points, Absorption absorption) {
    std::mt19937 random(5);
    Setup s;
    s.grid = {points, {1e-3, 1.1e-3, 0.9e-3}, 2e-6};
    s.pml.points = {3, 4, 5};
    if (points[0] == 1) {
        s.grid.is_plane = true;
        s.grid.moves_in_plane = true;
        s.pml.points[0] = 0;
    }
    s.absorption = absorption;
    std::vector<double> speeds;
    for (std::ptrdiff_t i = 0; i < points[0] * points[1] * points[2]; ++i)
        speeds.push_back(5.0 + 3.0 * static_cast<double>(random()) / 4294967296.0);
    s.material = [=](Node n) {
        const double speed =
            speeds[static_cast<std::size_t>((n[0] * points[1] + n[1]) * points[2] + n[2])];
        if (n[2] < 2) return NodeMaterial{1000.0, 0.0, 0.0, 0.0, 0.0, true};
        return NodeMaterial{1000.0 + speed, 20.0, n[2] < points[2] / 2 ? 0.0 : speed, 0.01,
                            0.002 * speed};
    };
    for (const pstd::Field field :
         {pstd::Field::uy, pstd::Field::uz, pstd::Field::syz, pstd::Field::szz, pstd::Field::sxx})
        for (const SourceMode mode : {SourceMode::additive, SourceMode::dirichlet}) {
            if (field == pstd::Field::sxx && s.grid.is_plane) continue;
            s.sources.push_back(random_source(s.grid, field, mode, random));
            s.sources.back().in_rates = field == pstd::Field::uz;
        }
    s.sources.push_back(random_source(s.grid, pstd::Field::uz, SourceMode::total, random));
    return s;
}

/// The largest difference relative to the largest value.
static double apart(const std::vector<double>& found, const std::vector<double>& expected) {
    REQUIRE(found.size() == expected.size());
    double worst = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (!std::isfinite(found[i])) return 1e300;
        worst = std::max(worst, std::abs(found[i] - expected[i]));
        largest = std::max(largest, std::abs(expected[i]));
    }
    return largest > 0.0 ? worst / largest : worst;
}

static std::unique_ptr<Scheme> on_device(const Setup& setup, Precision precision) {
    try {
        return make_scheme(setup, precision, {PstdDevice::gpu, -1}, Comm::world());
    } catch (const CaseFailure& error) {
        const std::string what = error.what();
        if (what.find("requires OpenCL") == std::string::npos &&
            what.find("offer no device") == std::string::npos &&
            what.find("without the headers") == std::string::npos)
            throw;
        WARN("not tested: " << what);
        return nullptr;
    }
}

/// Compares all fields, tallies, sensors, energies and a checkpoint after some steps.
static void compare(const Setup& setup, Precision precision, double tolerance) {
    const auto device = on_device(setup, precision);
    if (!device) return;
    const auto host = make_scheme(setup, precision, {}, Comm::world());
    constexpr int steps = 30;
    const SensorNodes nodes{
        .nodes = {{0, 3, 4}, {0, 5, 1}, {setup.grid.points[0] - 1, 2, 6}}, .first = 0, .count = 3};
    const std::array<Quantity, 2> quantities = {pressure_quantity, pstd::Field::uz};
    struct Observed {
        const Scheme& scheme;
        std::unique_ptr<Tally> sum, most, least;
        std::unique_ptr<Sensor> sensor;
    };
    const auto observe = [&](const Scheme& scheme) {
        return Observed{
            scheme,
            scheme.tally({.quantity = pstd::Field::uz, .first_z = 3, .planes = 4, .scale = 1e-3}),
            scheme.tally({.kind = Tally::Kind::max, .planes = setup.grid.points[2]}),
            scheme.tally({.quantity = pstd::Field::uy,
                          .kind = Tally::Kind::min,
                          .planes = setup.grid.points[2]}),
            scheme.sensor(nodes)};
    };
    const Observed found = observe(*device), expected = observe(*host);
    for (int n = 0; n < steps; ++n) {
        for (Scheme* scheme : {device.get(), host.get()})
            scheme->step();
        for (const Observed* each : {&found, &expected})
            for (const auto* tally : {&each->sum, &each->most, &each->least})
                (*tally)->add();
    }
    for (std::size_t f = 0; f < field_count; ++f) {
        INFO("field " << f);
        const auto field = static_cast<pstd::Field>(f);
        CHECK(apart(device->dense(field), host->dense(field)) < tolerance);
    }
    CHECK(apart(device->dense(pressure_quantity), host->dense(pressure_quantity)) < tolerance);
    CHECK(apart(found.sum->values(), expected.sum->values()) < tolerance);
    CHECK(apart(found.most->values(), expected.most->values()) < tolerance);
    CHECK(apart(found.least->values(), expected.least->values()) < tolerance);
    const auto values = found.sensor->values(quantities),
               expected_values = expected.sensor->values(quantities);
    for (std::size_t q = 0; q < quantities.size(); ++q)
        CHECK(apart(values[q], expected_values[q]) < tolerance);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto n = static_cast<std::size_t>(setup.grid.points[axis]);
        std::vector<double> weights(n);
        for (std::size_t i = 0; i < n; ++i)
            weights[i] = 1.0 / (1.0 + static_cast<double>(i));
        const auto field = static_cast<pstd::Field>(axis);
        CHECK(apart(found.sensor->line_sums(field, weights),
                    expected.sensor->line_sums(field, weights)) < tolerance);
    }
    // Energies are sums of squares of all nodes.
    CHECK(device->kinetic_J() == Approx(host->kinetic_J()).epsilon(10.0 * tolerance));
    CHECK(device->work_J() == Approx(host->work_J())
                                  .epsilon(10.0 * tolerance)
                                  .margin(10.0 * tolerance * host->kinetic_J()));
    // Either one resumes from a checkpoint of the other.
    test::MemoryState of_device, of_host;
    device->save(of_device);
    host->save(of_host);
    const auto device_resumed = on_device(setup, precision);
    const auto host_resumed = make_scheme(setup, precision, {}, Comm::world());
    device_resumed->restore(of_host);
    host_resumed->restore(of_device);
    for (Scheme* scheme : {device_resumed.get(), host_resumed.get(), host.get()})
        for (int n = 0; n < 5; ++n)
            scheme->step();
    CHECK(device_resumed->steps() == host->steps());
    for (const pstd::Field field : {pstd::Field::uz, pstd::Field::syz, pstd::Field::szz}) {
        CHECK(apart(device_resumed->dense(field), host->dense(field)) < tolerance);
        CHECK(apart(host_resumed->dense(field), host->dense(field)) < tolerance);
    }
}

// Rounding errors of 30 steps, in units of the largest value.
constexpr double double_tolerance = 1e-12, single_tolerance = 2e-5;

TEST_CASE("a GPU computes the fields of the processor", "[unit][pstd][gpu]") {
    // Radices 2, 3, 4, 5, 7, 8, 11, 13 and 17, and numbers of rows and columns that leave bundles
    // incomplete.
    for (const auto& points :
         {std::array<std::ptrdiff_t, 3>{15, 14, 26}, std::array<std::ptrdiff_t, 3>{16, 11, 17},
          std::array<std::ptrdiff_t, 3>{12, 9, 64}}) {
        INFO(points[0] << " x " << points[1] << " x " << points[2]);
        compare(random_setup(points, Absorption::kelvin_voigt), Precision::double_precision,
                double_tolerance);
    }
    compare(random_setup({15, 14, 26}, Absorption::none), Precision::double_precision,
            double_tolerance);
    compare(random_setup({15, 14, 26}, Absorption::kelvin_voigt), Precision::single_precision,
            single_tolerance);
}

TEST_CASE("a GPU computes planes", "[unit][pstd][gpu]") {
    compare(random_setup({1, 15, 26}, Absorption::none), Precision::double_precision,
            double_tolerance);
    compare(random_setup({1, 16, 17}, Absorption::kelvin_voigt), Precision::double_precision,
            double_tolerance);
}

/// A moving focus over a body, and a map of the viscosity where the load is prescribed.
static Case case_on(PstdDevice device, PstdLoad load) {
    Case c = test::moving_focus(test::half_space(test::tissue(50.0, 0.2)), ConstantSpeed{7.0});
    Body lump{.shape = Ellipsoid{{3e-3, 2e-3, 2e-3}}, .centre_m = {1e-3, -2e-3, 5e-3}};
    lump.density_kg_m3 = 1300.0;
    c.scene.medium.bodies = {lump};
    c.domain = {20, 14, 1.5e-3, 0.0};
    c.scene.load.footprint = GaussianFootprint{6e-3};
    std::get<Line>(test::travel_of(c).path.shape).from_m = {-8e-3, 1e-3};
    c.time = {4, 250e-6};
    c.measure.at_s = 1e-3;
    c.measure.depths_m = {0.0, 2e-3};
    c.record.volumes_s = {0.5e-3, 1e-3};
    c.record.volume_fields = {VolumeField::u};
    PstdOptions options;
    options.depth_m = 9e-3;
    options.absorbing_points = 8;
    options.load = load;
    options.displacement_m = 4e-6;
    options.velocity_m_s = 0.01;
    options.prescribed = PstdPrescribed::focus;
    if (load != PstdLoad::velocity) options.top = PstdTop::continued;
    options.device = device;
    c.solver = options;
    return c;
}

TEST_CASE("engine pstd has the same frames on a GPU and resumes there", "[unit][pstd][gpu]") {
    if (!on_device(random_setup({1, 8, 12}, Absorption::none), Precision::double_precision)) return;
    for (const PstdLoad load : {PstdLoad::traction, PstdLoad::displacement, PstdLoad::velocity}) {
        const Case on_cpu = case_on(PstdDevice::cpu, load), on_gpu = case_on(PstdDevice::gpu, load);
        test::VolumeStore host, device, resumed;
        PstdEngine().run(on_cpu, Comm::world(), host, nullptr);
        PstdEngine().run(on_gpu, Comm::world(), device, nullptr);
        test::StopAt checkpoints(60);
        PstdEngine().run(on_cpu, Comm::world(), resumed, &checkpoints);
        PstdEngine().run(on_gpu, Comm::world(), resumed, &checkpoints);
        for (const test::VolumeStore* found : {&device, &resumed}) {
            for (std::size_t depth = 0; depth < 2; ++depth)
                CHECK(apart(found->FrameStore::at(3, depth), host.FrameStore::at(3, depth)) <
                      double_tolerance);
            for (std::size_t component = 0; component < 3; ++component)
                for (std::size_t level = 0; level < host.z_m().size(); ++level)
                    CHECK(apart(found->at(1, 0, component, level),
                                host.at(1, 0, component, level)) < double_tolerance);
        }
    }
}

} // namespace test_pstd_device
