// SPDX-License-Identifier: BSD-3-Clause
// The energy of engine pstd: what its sources supply limits the kinetic energy of a stable field.
#include "engines/pstd/scene/case_load.hpp"
#include "engines/pstd/scene/case_step.hpp"
#include "support/cases.hpp"
#include "support/pstd_recording.hpp"
#include "support/pstd_sources.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

namespace test_pstd_energy {

using namespace shearwake;
using namespace shearwake::pstd;

constexpr double spacing_m = 1e-3;
const pstd::NodeMaterial solid{1000.0, 20.0, 5.0}, fluid{1000.0, 20.0, 0.0};

/// A periodic box without absorbing layer, of which the step is `share` of the largest stable one.
static pstd::Setup box(const pstd::NodeMaterial& material, double share) {
    pstd::Setup s;
    s.grid = {{11, 9, 16},
              {spacing_m, spacing_m, spacing_m},
              share * pstd::largest_step_s(material, spacing_m)};
    s.pml.strength_1 = {0.0, 0.0, 0.0};
    s.material = [material](pstd::Node) { return material; };
    return s;
}

/// Pa on all normal stresses of a node, in the first step.
static void add_pressure(pstd::Setup& setup, double pressure_Pa) {
    for (const pstd::Field field : {pstd::Field::sxx, pstd::Field::syy, pstd::Field::szz}) {
        pstd::Source source{.field = field, .scaling = pstd::SourceScaling::none};
        source.nodes = {{5, 4, 7}};
        setup.sources.push_back(test::sampled_source(source, {pressure_Pa}));
    }
}

/// A focus over tissue with a light, stiff lump, of few points.
static Case scene(PstdTop top, PstdLoad load) {
    Case c = test::moving_focus(test::half_space(test::tissue(50.0, 0.2)), ConstantSpeed{7.0});
    Body lump;
    lump.shape = Ellipsoid{{6e-3, 5e-3, 4e-3}};
    lump.centre_m = {1e-3, -2e-3, 7e-3};
    lump.density_kg_m3 = 600.0;
    c.scene.medium.bodies = {lump};
    c.domain = {20, 14, 1.5e-3, 0.0};
    c.scene.load.footprint = GaussianFootprint{6e-3};
    std::get<Line>(test::travel_of(c).path.shape).from_m = {-8e-3, 1e-3};
    c.time = {8, 250e-6};
    c.measure.at_s = 1e-3;
    PstdOptions options;
    options.depth_m = 12e-3;
    options.absorbing_points = 8;
    options.top = top;
    options.load = load;
    options.displacement_m = 1e-6;
    c.solver = options;
    return c;
}

/// Largest kinetic energy relative to the largest work until then, from the step `first`.
static double largest_ratio(const Case& c) {
    const auto& options = std::get<PstdOptions>(c.solver);
    const pstd::CaseGrid grid = pstd::case_grid(c, options);
    const pstd::StepChoice step =
        pstd::choose_step(c, options, pstd::extremes_of_grid(c, options, grid));
    pstd::Setup setup;
    setup.grid = {grid.points, {grid.spacing_m, grid.spacing_m, grid.spacing_m}, step.step_s};
    setup.pml = pstd::absorbing_layer(c, options);
    setup.material = [&](pstd::Node node) { return pstd::material_at(c, options, grid, node); };
    setup.absorption = pstd::Absorption::kelvin_voigt;
    setup.sources = {pstd::load_source(c, options, grid, step.step_s)};
    const Comm world = Comm::world();
    pstd::Stepper<double> stepper(setup, world);
    double work_J = 0.0, ratio = 0.0;
    while (stepper.steps() < c.time.frames * step.per_frame) {
        stepper.step();
        work_J = std::max(work_J, world.sum(stepper.work_J()));
        ratio = std::max(ratio, world.sum(stepper.kinetic_J()) / work_J);
    }
    return ratio;
}

TEST_CASE("the work of a force on a lossless medium of engine pstd is its energy", "[mpi][pstd]") {
    const Comm world = Comm::world();
    pstd::Setup setup = box(solid, 0.02);
    pstd::Source force{.field = pstd::Field::uz, .scaling = pstd::SourceScaling::none};
    force.nodes = {{5, 4, 7}, {6, 4, 7}, {0, 0, 0}};
    setup.sources.push_back(test::sampled_source(force, std::vector<double>(3 * 120, 1e-3)));
    pstd::Stepper<double> stepper(setup, world);
    while (stepper.steps() < 300)
        stepper.step();
    const double energy_J = world.sum(stepper.kinetic_J() + stepper.elastic_J()),
                 work_J = world.sum(stepper.work_J());
    CAPTURE(energy_J, work_J);
    CHECK(work_J > 0.0);
    // The preserved energy has the velocities of two successive steps. The two differ by r = 0.02
    // of the energy at most (pstd_march.cpp).
    CHECK(energy_J == Approx(work_J).epsilon(0.02));
}

TEST_CASE("elastic energy of a pressure in engine pstd is p^2/(2 K)", "[mpi][pstd]") {
    const pstd::NodeMaterial material = GENERATE(solid, fluid);
    const Comm world = Comm::world();
    pstd::Setup setup = box(material, 0.5);
    add_pressure(setup, 3.0);
    pstd::Stepper<double> stepper(setup, world);
    stepper.step();
    const double bulk_Pa = material.lambda_Pa() + 2.0 / 3.0 * material.mu_Pa();
    const double elastic_J = world.sum(stepper.elastic_J());
    // Rounding errors.
    CHECK(elastic_J == Approx(9.0 / (2.0 * bulk_Pa) * std::pow(spacing_m, 3)).epsilon(1e-12));
}

TEST_CASE("kinetic energy in engine pstd does not exceed the work of the load", "[mpi][pstd]") {
    const PstdTop top = GENERATE(PstdTop::nothing, PstdTop::continued, PstdTop::fluid);
    const PstdLoad load = GENERATE(PstdLoad::traction, PstdLoad::displacement);
    const double ratio = largest_ratio(scene(top, load));
    CAPTURE(static_cast<int>(top), static_cast<int>(load), ratio);
    CHECK(ratio > 0.5);
    // In the first step from rest all of the work is kinetic energy, apart from rounding errors. A
    // run is ended at 20.
    CHECK(ratio < 1.0 + 1e-9);
}

} // namespace test_pstd_energy
