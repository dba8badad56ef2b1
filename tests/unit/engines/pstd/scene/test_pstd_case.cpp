// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/pstd_engine.hpp"
#include "engines/pstd/scene/case_load.hpp"
#include "engines/pstd/scene/case_step.hpp"
#include "engines/pstd/scene/displacements.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <numbers>
#include <numeric>

namespace test_pstd_case {

using namespace shearwake;
using namespace shearwake::pstd;

static Case small_case() {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0, 1.0)), ConstantSpeed{7.0});
    c.domain = {40, 32, 1e-3, 0.0};
    c.time = {20, 50e-6};
    c.solver = PstdOptions{};
    return c;
}

static std::vector<double> values_of(pstd::Source& source, std::ptrdiff_t sample) {
    std::vector<std::size_t> which(source.nodes.size());
    std::iota(which.begin(), which.end(), 0);
    std::vector<double> values(which.size(), 7.0);
    source.values(sample, which, values);
    return values;
}

static bool any_has(const std::vector<std::string>& texts, const std::string& part) {
    return std::any_of(texts.begin(), texts.end(), [&](const std::string& text) {
        return text.find(part) != std::string::npos;
    });
}

TEST_CASE("largest step satisfies the stability bound with equality", "[pstd]") {
    const double d_m = 1e-3, k2 = 3.0 * std::pow(std::numbers::pi / d_m, 2);
    const pstd::NodeMaterial lossless{1000.0, 50.0, 5.0};
    // docs/explanation/engine-pstd.md, "Stability": 2/(pi sqrt 3) d/c_p.
    CHECK(pstd::largest_step_s(lossless, d_m) ==
          Approx(2.0 / (std::numbers::pi * std::sqrt(3.0)) * d_m / 50.0).epsilon(1e-13));
    const double eta = GENERATE(0.1, 1.0, 30.0);
    const pstd::NodeMaterial lossy{1000.0, 50.0, 5.0, 0.0, eta};
    const double dt = pstd::largest_step_s(lossy, d_m);
    CHECK(dt * dt * 2500.0 * k2 + 2.0 * dt * k2 * 2.0 * eta / 1000.0 == Approx(4.0).epsilon(1e-12));
    pstd::Extremes alone;
    alone.add(lossy, d_m);
    CHECK(pstd::safe_step_s(alone, d_m) == Approx(dt).epsilon(1e-12));
    CHECK(alone.alone_s == dt);
    // Next to a light material the stiffness of the other one acts on the light one.
    alone.add({250.0, 50.0, 5.0}, d_m);
    CHECK(pstd::safe_step_s(alone, d_m) < 0.6 * dt);
}

TEST_CASE("a light layer between nodes limits the step by its own density", "[pstd]") {
    Case c = small_case();
    c.domain.spacing_m = 1e-3;
    Layer light = c.scene.medium.layers.front(), below = light;
    light.density_kg_m3 = 0.5 * below.density_kg_m3;
    light.thickness_m = 1e-3;
    c.scene.medium.layers.insert(c.scene.medium.layers.begin() + 1, {light, below});
    c.scene.medium.layers.front().thickness_m = 0.5e-3;
    const auto& options = std::get<PstdOptions>(c.solver);
    // The nodes see half of it and half of a neighbour, the point of u_z between them all of it.
    CHECK(pstd::extremes_of_grid(c, options, pstd::case_grid(c, options)).least_density_kg_m3 ==
          Approx(light.density_kg_m3).epsilon(1e-12));
}

TEST_CASE("caps c_p with a note and rejects an unstable time step with its value", "[pstd]") {
    Case c = small_case();
    auto& options = std::get<PstdOptions>(c.solver);
    CHECK(pstd::capped_material(c.scene.medium.layers[0], options).c_p_m_s ==
          Approx(50.0).epsilon(1e-13));
    const auto notes = pstd::PstdEngine().choices(c);
    CHECK(any_has(notes, "is capped at 50 m/s, 10 times c_s, instead of 1500 m/s"));
    CHECK(any_has(notes, "error of the surface field: 3.2 % for a focus"));
    CHECK(any_has(notes, "4 / 2 / 1 % of the surface field"));
    const pstd::StepChoice free = pstd::choose_step(
        c, options, pstd::extremes_of_grid(c, options, pstd::case_grid(c, options)));
    CHECK(free.step_s <= 0.95 * free.safe_s);
    CHECK(free.step_s * static_cast<double>(free.per_frame) == Approx(50e-6).epsilon(1e-14));

    options.time_step_s = 20e-6;
    CHECK(any_has(pstd::PstdEngine().choices(c), "solver.pstd.time_step_us = 20 is unstable"));
    test::FrameStore store;
    const Comm alone = Comm::world().split(Comm::world().rank());
    CHECK_THROWS_WITH(pstd::PstdEngine().run(c, alone, store, nullptr),
                      Catch::Contains("solver.pstd.time_step_us = 20 is unstable on this grid"));
}

TEST_CASE("a displacement larger than the domain fails the case and names the step", "[pstd]") {
    Case c = small_case();
    c.scene.load.modulation.trajectory = {{Travel{{{0.0, 0.0}, {9e-3, 0.0}}, ConstantSpeed{7.0}}}};
    c.scene.load.peak_Pa = 1e13; // the scheme is linear: as large as after an instability
    test::FrameStore store;
    const Comm alone = Comm::world().split(Comm::world().rank());
    CHECK_THROWS_WITH(pstd::PstdEngine().run(c, alone, store, nullptr),
                      Catch::Contains("exceeds the size of the domain, 40 mm, at frame") &&
                          Catch::Contains("the time step of") &&
                          Catch::Contains("a smaller solver.pstd.time_step_us may help"));
}

TEST_CASE("supports an empty, fluid or continued medium above and cells with two layers",
          "[pstd]") {
    Case c = small_case();
    Layer film = c.scene.medium.layers[0];
    film.thickness_m = 1.5e-3;
    film.density_kg_m3 = 1200.0;
    c.scene.medium.layers.insert(c.scene.medium.layers.begin(), film);
    PstdOptions options;
    const auto at = [&](std::ptrdiff_t below_surface) {
        const pstd::CaseGrid grid = pstd::case_grid(c, options);
        return pstd::material_at(c, options, grid, {3, 3, grid.surface + below_surface});
    };
    CHECK(at(-1).empty);
    CHECK(at(-1).density_kg_m3 == 1200.0);
    CHECK(at(-1).lambda_Pa() == 0.0);
    CHECK(at(0).density_kg_m3 == Approx(1200.0).epsilon(1e-14));
    CHECK(at(1).density_kg_m3 == Approx(1100.0).epsilon(1e-14)); // 1 to 2 mm deep
    CHECK(at(2).density_kg_m3 == Approx(1000.0).epsilon(1e-14));
    const pstd::CaseGrid grid = pstd::case_grid(c, options);
    const pstd::MaterialOfNode material = [&](pstd::Node n) {
        return pstd::material_at(c, options, grid, n);
    };
    const pstd::Grid counts{grid.points, {1e-3, 1e-3, 1e-3}, 1e-6};
    // Half a cell of the skin at z = 0, and the density of the empty nodes above.
    CHECK(pstd::density_between(counts, material, {3, 3, grid.surface - 1}, 2) == Approx(600.0));
    CHECK(pstd::density_between(counts, material, {3, 3, grid.surface - 2}, 2) == Approx(1200.0));
    options.top = PstdTop::continued;
    CHECK(at(-1) == at(0));
    options.top = PstdTop::fluid;
    CHECK(at(-1) == pstd::NodeMaterial{1000.0, 50.0, 0.0});
    c.scene.medium.base = Base::rigid;
    c.scene.medium.layers.back().thickness_m = 10e-3;
    CHECK(at(12).density_kg_m3 > 1e8);
}

TEST_CASE("cells around staggered points are laminates at the surface of a body", "[pstd]") {
    Case c = small_case();
    const double mu_Pa = 1000.0 * 25.0;
    c.scene.medium.bodies = {{.name = "box",
                              .shape = Box{{5e-3, 6e-3, 3e-3}},
                              .centre_m = {0.0, 0.0, 3.75e-3}, // its top is 2.25 mm deep
                              .density_kg_m3 = 1400.0,
                              .c_s_m_s = std::sqrt(4.0 * mu_Pa / 1400.0)}};
    const PstdOptions options;
    const pstd::CaseGrid grid = pstd::case_grid(c, options);
    const pstd::StaggeredMaterial between = pstd::staggered_material(c, options, grid);
    // Around z = 2 mm, a quarter of the cell is the body.
    const pstd::Node middle{20, 16, grid.surface + 1};
    CHECK(between.density_kg_m3[2](middle) == Approx(1100.0));
    CHECK(between.mu_Pa[1](middle) == Approx(mu_Pa / (0.75 + 0.25 / 4.0)));
    CHECK(between.mu_Pa[2](middle) == Approx(mu_Pa / (0.75 + 0.25 / 4.0)));
    // The shear strain of x and y lies along the surface.
    const pstd::Node below{20, 16, grid.surface + 2}; // 2 to 3 mm deep
    CHECK(between.mu_Pa[0](below) > mu_Pa / (0.25 + 0.75 / 4.0));
    // Half of the cell around x = 3 mm is the body, whose face has the normal x.
    const pstd::Node side{22, 16, grid.surface + 3};
    CHECK(between.mu_Pa[0](side) == Approx(mu_Pa / (0.5 + 0.5 / 4.0)));
    CHECK(between.density_kg_m3[1](side) == Approx(1400.0));
    // There is no stiffness at the skin, next to the empty nodes.
    CHECK(between.mu_Pa[1]({20, 16, grid.surface - 1}) == 0.0);
}

TEST_CASE("load equals the Gaussian's pressure inside its cutoff and zero outside", "[pstd]") {
    Case c = small_case();
    c.scene.load.peak_Pa = 100.0;
    c.scene.load.modulation.trajectory = {{Hold{{2.3e-3, -1.2e-3}}}};
    const PstdOptions options;
    const pstd::CaseGrid grid = pstd::case_grid(c, options);
    pstd::Source source = pstd::load_source(c, options, grid, 1e-5);
    const auto values = values_of(source, 5);
    const std::size_t planes = source.nodes.size() / static_cast<std::size_t>(40 * 32);
    REQUIRE(planes == 11);
    double worst = 0.0;
    for (std::size_t n = 0; n < values.size(); ++n) {
        const pstd::Node& node = source.nodes[n];
        const double p = 100.0 * pressure(c.scene.load.footprint, c.domain.x_m(node[0]) - 2.3e-3,
                                          c.domain.y_m(node[1]) + 1.2e-3);
        if (node[2] >= grid.surface - 4) worst = std::max(worst, std::abs(values[n] + p));
        CHECK_FALSE(values[n] > 0.0);
        CHECK_FALSE(node[2] >= grid.surface);
    }
    CHECK(worst < 2e-8 * 100.0); // value at six standard deviations
    // The first sample also compensates for the half step before it.
    const auto first = values_of(source, 0);
    for (std::size_t n = 0; n < values.size(); n += 97)
        CHECK(first[n] == Approx(1.5 * values[n]).epsilon(1e-12));
}

TEST_CASE("prescribes the displacement of the skin under the focus only", "[pstd]") {
    Case c = small_case();
    c.scene.load.modulation.trajectory = {{Hold{{0.0, 0.0}}}};
    c.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = 500.0}}};
    PstdOptions options;
    options.load = PstdLoad::displacement;
    options.displacement_m = 4e-6;
    const double step_s = 1e-5;
    pstd::Source source = pstd::load_source(c, options, pstd::case_grid(c, options), step_s);
    CHECK(source.mode == pstd::SourceMode::total);
    CHECK(source.nodes.size() > 30);
    CHECK(source.nodes.size() < 130); // within 1.6 widths of 3 points: pi (4.7)^2 = 70
    std::vector<double> moved(source.nodes.size(), 0.0);
    for (std::ptrdiff_t n = 0; n < 100; ++n) {
        const auto v = values_of(source, n);
        for (std::size_t i = 0; i < v.size(); ++i)
            moved[i] += step_s * v[i];
    }
    // At 1 ms the envelope is 1.
    CHECK(*std::max_element(moved.begin(), moved.end()) == Approx(4e-6).epsilon(1e-9));
}

TEST_CASE("prescribes the motion only where the focus is at the moment, and elsewhere nothing",
          "[pstd]") {
    Case c = small_case();
    c.scene.load.modulation.trajectory = {
        {Travel{{{-6e-3, 0.0}, {6e-3, 0.0}}, ConstantSpeed{7.0}}}};
    c.scene.load.modulation.envelope = {};
    PstdOptions options;
    options.load = PstdLoad::velocity;
    options.velocity_m_s = 2e-3;
    const double step_s = 1e-5;
    const auto source_of = [&] {
        return pstd::load_source(c, options, pstd::case_grid(c, options), step_s);
    };
    pstd::Source path = source_of();
    options.prescribed = PstdPrescribed::focus;
    pstd::Source focus = source_of();
    REQUIRE(path.nodes == focus.nodes);
    const auto everywhere = values_of(path, 50), moving = values_of(focus, 50);
    std::size_t released = 0;
    double largest = 0.0;
    for (std::size_t i = 0; i < moving.size(); ++i) {
        largest = std::max(largest, everywhere[i]);
        if (std::isnan(moving[i])) {
            ++released;
            CHECK(everywhere[i] <= 1e-3 * options.velocity_m_s); // the limit of "covers"
        } else {
            CHECK(moving[i] == everywhere[i]);
        }
    }
    CHECK(released > 20);
    CHECK(released + 20 < moving.size());
    CHECK(largest > 0.8 * options.velocity_m_s); // half a cell of 1 mm from the centre of 3 mm
    CHECK(largest <= options.velocity_m_s);
}

TEST_CASE("interpolates depths between planes and the oscillating surface from five planes",
          "[pstd]") {
    CHECK(pstd::depth_weights(0.0, 1e-3, pstd::SurfacePlane::accurate) == std::vector{1.0});
    CHECK(pstd::depth_weights(2e-3, 1e-3, pstd::SurfacePlane::rings) == std::vector{0.0, 0.0, 1.0});
    const auto between = pstd::depth_weights(1.25e-3, 1e-3, pstd::SurfacePlane::rings);
    REQUIRE(between.size() == 3);
    CHECK(between[1] == Approx(0.75));
    CHECK(between[2] == Approx(0.25));
    const auto surface = pstd::depth_weights(0.0, 1e-3, pstd::SurfacePlane::rings);
    REQUIRE(surface.size() == 5);
    // Planes of a field that does not vary with depth.
    const std::array ringing = {0.9255, 1.0148, 0.9943, 1.0035, 0.9974};
    CHECK(std::inner_product(surface.begin(), surface.end(), ringing.begin(), 0.0) ==
          Approx(1.0).margin(0.02));
}

TEST_CASE("the step that is planned is the one that is used, with bodies", "[pstd]") {
    Case c = small_case();
    // Stiff and only below the first layer: combined with the light film it would limit the step.
    Layer film = c.scene.medium.layers[0];
    film.thickness_m = 1.5e-3;
    film.density_kg_m3 = 400.0;
    c.scene.medium.layers.insert(c.scene.medium.layers.begin(), film);
    Body body;
    body.shape = Ellipsoid{.semi_axes_m = {3e-3, 3e-3, 2e-3}};
    body.centre_m = {0.0, 0.0, 5e-3};
    body.c_s_m_s = 9.0;
    c.scene.medium.bodies = {body};
    const pstd::PstdEngine planned;
    REQUIRE(planned.step_chooser(c));
    const double step_s = planned.step_chooser(c)({});

    struct : test::FrameStore {
        engines::SolverReport report;
        void solved(const engines::SolverReport& r) override { report = r; }
    } store;
    const Comm alone = Comm::world().split(Comm::world().rank());
    c.time.frames = 2;
    pstd::PstdEngine().run(c, alone, store, nullptr);
    CHECK(static_cast<double>(store.report.steps) * step_s ==
          Approx(c.time.duration_s()).epsilon(1e-12));
    CHECK(planned.choices(c) == store.report.notes);
    // With the step specified, the estimate is that of the same number of steps.
    const double amount = planned.resources(c, 1).work;
    std::get<PstdOptions>(c.solver).time_step_s = step_s;
    CHECK(planned.resources(c, 1).work == amount);
}

} // namespace test_pstd_case
