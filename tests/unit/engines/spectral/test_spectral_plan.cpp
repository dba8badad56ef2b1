// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_plan.hpp"
#include "engines/spectral/stepping/stepper.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "support/cases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

namespace test_spectral_plan {

using namespace shearwake;

constexpr double step_s = 50e-6;

/// A body with `contrast` times the shear stiffness, or none for 1, under a 3 mm focus: 48 x 36
/// points, two elements.
static Case body_case(double contrast) {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0, 1.0)), ConstantSpeed{7.0});
    c.scene.medium.base = Base::rigid;
    c.scene.medium.layers[0].thickness_m = 8e-3;
    test::travel_of(c).path = {{-6e-3, 0.0}, {200e-3, 0.0}};
    if (contrast != 1.0)
        c.scene.medium.bodies = {{.name = "body",
                                  .shape = Ellipsoid{{9e-3, 6e-3, 2e-3}},
                                  .centre_m = {0.0, 2e-3, 3.5e-3},
                                  .c_s_m_s = 5.0 * std::sqrt(contrast)}};
    c.domain = {48, 36, 1e-3, 0.0};
    c.time = {20, step_s};
    c.solver = SpectralOptions{.time_step_s = step_s};
    return c;
}

static spectral::DepthMesh mesh_of(const Case& c) {
    return spectral::choose_mesh(c, std::get<SpectralOptions>(c.solver));
}

static spectral::SpectralPlan plan_of(const Case& c) {
    return spectral::SpectralPlan(c, mesh_of(c), {.step_s = step_s});
}

/// Without the program.
static double planned_B(const Case& c, int ranks = 1) {
    return plan_of(c).resources(ranks).memory_per_rank_B() - engines::program_B;
}

static spectral::VariationPlan variation_of(const Case& c, int ranks = 1) {
    return plan_of(c).variation(plan_of(c).sampled_variation(), ranks);
}

struct Found {
    bool iterates, uses_box;
};

/// What a stepper does in some steps.
static Found found(const Case& c) {
    const Comm alone = Comm::world().split(Comm::world().rank());
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, alone);
    spectral::Stepper stepper(c, mesh_of(c), slabs, step_s, alone);
    for (int n = 0; n < 20; ++n)
        stepper.advance();
    return {stepper.statistics().iterations > 0, stepper.box().has_value()};
}

TEST_CASE("iterations and the box are planned where the stepper uses them", "[spectral]") {
    Case c = body_case(GENERATE(1.0, 4.0, 100.0));
    SECTION("unchanged") {}
    SECTION("with one solve per step") {
        std::get<SpectralOptions>(c.solver).method = SpectralMethod::one_solve;
    }
    SECTION("softer, so that the cells around it vary") {
        for (Body& body : c.scene.medium.bodies)
            body.c_s_m_s = 2.0;
        c.time.frames = 1000; // a box would pay
    }
    SECTION("denser") {
        if (!c.scene.medium.bodies.empty()) c.scene.medium.bodies[0].density_kg_m3 = 1900.0;
    }
    const spectral::VariationPlan planned = variation_of(c);
    const Found used = found(c);
    CHECK(planned.iterates == used.iterates);
    CHECK(planned.box.has_value() == used.uses_box);
}

TEST_CASE("many small bodies have the planned box, although their cells are sampled",
          "[spectral]") {
    Case c = body_case(4.0);
    c.scene.medium.layers[0].thickness_m = 30e-3;
    c.domain = {96, 72, 1e-3, 0.0};
    const Body body = c.scene.medium.bodies[0];
    c.scene.medium.bodies.clear();
    for (int i = 0; i < 12; ++i) {
        Body small = body;
        small.shape = Ellipsoid{{1.7e-3, 1.7e-3, 1.7e-3}};
        small.density_kg_m3 = 1300.0;
        small.centre_m = {4.1e-3 * (i % 4 - 1.5), 4.1e-3 * (i / 4 - 1), 4e-3};
        c.scene.medium.bodies.push_back(small);
    }
    bool box_before = false; // longer runs have one
    int changes = 0;
    const Comm alone = Comm::world().split(Comm::world().rank());
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, alone);
    for (c.time.frames = 3; c.time.frames < 1000; c.time.frames *= 100) {
        const spectral::VariationPlan planned = variation_of(c);
        const spectral::Stepper stepper(c, mesh_of(c), slabs, step_s, alone);
        REQUIRE(planned.box.has_value() == stepper.box().has_value());
        changes += planned.box.has_value() != box_before;
        box_before = planned.box.has_value();
        if (planned.box) {
            CHECK(planned.box->nx == stepper.box()->nx);
            CHECK(planned.box->ny == stepper.box()->ny);
        }
    }
    CHECK(changes == 1);
}

TEST_CASE("the bounds of bodies and maps contain their cells closely", "[spectral]") {
    Case c = body_case(4.0);
    Body body = c.scene.medium.bodies[0];
    const auto [x_m, y_m, radius_m] =
        GENERATE(table<double, double, double>({{-22e-3, 0.0, 4.5e-3}, // beyond the edge
                                                {0.0, 0.4e-3, 2.5e-3}, // ends at a cell's edge
                                                {0.25e-3, -4e-3, 3.4e-3}}));
    body.centre_m.x = x_m;
    body.centre_m.y = y_m;
    SECTION("ellipsoid") {
        body.shape = Ellipsoid{{radius_m, 0.8 * radius_m, 2e-3}};
    }
    SECTION("turned box") {
        body.shape =
            Box{.size_m = {radius_m, 2.0 * radius_m, 3e-3}, .orientation = {.azimuth_deg = 30.0}};
    }
    SECTION("smooth") {
        body.shape = Ellipsoid{{radius_m, radius_m, 2e-3}};
        body.edge_m = 1e-3;
    }
    SECTION("map") {
        auto map = std::make_shared<MaterialMap>();
        map->counts = {5, 4, 3};
        map->spacing_m = {radius_m, 0.8 * radius_m, 1e-3};
        map->origin_m = {body.centre_m.x, body.centre_m.y, 2e-3};
        map->c_s_m_s.assign(60, 9.0);
        c.scene.medium.map = map;
    }
    if (!c.scene.medium.map)
        c.scene.medium.bodies = {body};
    else
        c.scene.medium.bodies.clear();
    fft::SlabShare all;
    all.x_count = c.domain.nx;
    const spectral::LateralVariation v = spectral::lateral_variation(
        c, mesh_of(c), all, spectral::largest_k_rad_m(c.domain), step_s, nullptr);
    const spectral::CellExtent cells = spectral::PlaneCells{.points = v.points}.extent(nullptr),
                               bounds = spectral::extent_of(c.scene.medium, c.domain);
    // A cell that touches a bound may differ by rounding.
    CHECK(cells.x_begin >= bounds.x_begin - 1);
    CHECK(cells.x_end <= bounds.x_end + 1);
    CHECK(cells.y_begin >= bounds.y_begin - 1);
    CHECK(cells.y_end <= bounds.y_end + 1);
    // A corner may fill less of it than its samples resolve. A
    // smooth edge begins with a change below rounding.
    const std::ptrdiff_t most = body.edge_m > 0.0 ? 4 : 2;
    CHECK(cells.x_begin - bounds.x_begin + bounds.x_end - cells.x_end <= most);
    CHECK(cells.y_begin - bounds.y_begin + bounds.y_end - cells.y_end <= most);
}

TEST_CASE("the stages allocate the arrays that are planned", "[spectral]") {
    Case c = body_case(GENERATE(1.0, 16.0));
    std::vector<std::string> expected = {"factors", "displacement"};
    SECTION("on planes") {}
    SECTION("in a box") {
        c.domain = {96, 72, 1e-3, 0.0};
        c.time.frames = 100000;
        if (!c.scene.medium.bodies.empty()) {
            c.scene.medium.bodies[0].shape = Ellipsoid{{4e-3, 3e-3, 2e-3}};
            expected.emplace_back("box of elastic bodies");
            expected.emplace_back("prediction of the next step");
        }
    }
    SECTION("with a sponge") {
        c.domain.sponge_m = 6e-3;
        expected.emplace_back("sponge");
    }
    SECTION("with a rigid cylinder") {
        c.scene.medium.bodies = {{.name = "bone",
                                  .shape = Cylinder{.radius_m = 2e-3, .azimuth_deg = 90.0},
                                  .centre_m = {0.0, 0.0, 4e-3},
                                  .density_kg_m3 = 1900.0,
                                  .rigid = true}};
        expected.emplace_back("endless rigid bodies");
    }
    SECTION("with a rigid lump") {
        c.scene.medium.bodies = {{.name = "lump",
                                  .shape = Ellipsoid{{5e-3, 4e-3, 2.5e-3}},
                                  .centre_m = {0.0, 0.0, 4e-3},
                                  .density_kg_m3 = 1900.0,
                                  .rigid = true}};
        expected.emplace_back("rigid lumps");
    }
    SECTION("with strain, stress and receptors") {
        c.record.volumes_s = {c.time.frame_s(0)};
        c.record.volume_fields = {VolumeField::strain, VolumeField::stress};
        c.afferents.emplace();
        c.afferents->input = StressInput{};
        expected.insert(expected.end(), {"volumes of strain and stress", "stress at receptors"});
    }
    const Comm alone = Comm::world().split(Comm::world().rank());
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, alone);
    spectral::Stepper stepper(c, mesh_of(c), slabs, step_s, alone, 1);
    stepper.advance(); // the first iteration in a box allocates its right-hand side
    std::vector<std::string> found;
    for (const engines::Allocation& array : stepper.arrays()) {
        if (array.bytes == 0.0) continue;
        found.push_back(array.name);
        double planned = 0.0;
        for (const engines::Allocation& other : plan_of(c).resources(1).arrays)
            if (other.name == array.name) planned = other.bytes;
        INFO(array.name);
        CHECK(planned == Approx(array.bytes).epsilon(0.1)); // what plan promises
    }
    for (const std::string& name : expected)
        CHECK(std::count(found.begin(), found.end(), name) == 1);
}

TEST_CASE("the work grows with the number of steps and with bodies", "[spectral]") {
    const auto work = [](const Case& c) { return plan_of(c).resources(1).work; };
    const Case none = body_case(1.0);
    Case longer = none, longest = none;
    longer.time.frames *= 10;
    longest.time.frames *= 19;
    CHECK(work(longest) - work(longer) == Approx(work(longer) - work(none)).epsilon(1e-12));
    CHECK(work(longer) > 5.0 * work(none));
    CHECK(work(body_case(16.0)) > 1.5 * work(none));
}

TEST_CASE("memory per rank decreases with the number of ranks and is largest above a body",
          "[spectral]") {
    const Case c = body_case(16.0);
    const double one = planned_B(c, 1);
    const double four = planned_B(c, 4);
    CHECK(four > one / 4.0);
    // 19 ky are divided into at most 5 per rank; blocks of 8 lanes stay complete.
    CHECK(four < one / 2.0);
    const spectral::VariationPlan v = variation_of(c, 4);
    CHECK(v.fullest_cells > 0.25 * v.cells);
    CHECK(v.fullest_cells <= v.cells);
}

TEST_CASE("counts cells only where the map extends", "[spectral]") {
    Case c = body_case(1.0);
    auto map = std::make_shared<MaterialMap>();
    map->counts = {2, 2, 2};
    map->origin_m = {-4e-3, -4e-3, 1e-3};
    map->spacing_m = {8e-3, 8e-3, 1e-3};
    map->c_s_m_s = {5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 20.0};
    map->content_hash = hash_of(*map);
    c.scene.medium.map = map;
    const spectral::VariationPlan v = variation_of(c);
    CHECK(v.iterates); // the last point of the map is found
    CHECK(v.points >= 3.0);
    CHECK(v.cells < v.points * 17 * 17); // one of eight points of the map differs
}

} // namespace test_spectral_plan
