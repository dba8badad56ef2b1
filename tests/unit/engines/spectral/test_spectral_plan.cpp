// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_plan.hpp"
#include "engines/spectral/stepping/stepper.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "support/cases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

namespace test_spectral_plan {

using namespace shearwake;

namespace {

constexpr double step_s = 50e-6;

/// A body with `contrast` times the shear stiffness, or none for 1, under a 3 mm focus: 48 x 36
/// points, two elements.
Case body_case(double contrast) {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0, 1.0)), ConstantSpeed{7.0});
    c.scene().medium.base = Base::rigid;
    c.scene().medium.layers[0].thickness_m = 8e-3;
    std::get<Travel>(c.scene().load.modulation.trajectory.parts[0]).path = {{-6e-3, 0.0},
                                                                            {200e-3, 0.0}};
    if (contrast != 1.0)
        c.scene().medium.bodies = {{.name = "body",
                                    .shape = Ellipsoid{{9e-3, 6e-3, 2e-3}},
                                    .centre_m = {0.0, 2e-3, 3.5e-3},
                                    .c_s_m_s = 5.0 * std::sqrt(contrast)}};
    c.domain = {48, 36, 1e-3, 0.0};
    c.time = {20, step_s};
    c.solver = SpectralOptions{.time_step_s = step_s};
    return c;
}

spectral::DepthMesh mesh_of(const Case& c) {
    return spectral::choose_mesh(c, std::get<SpectralOptions>(c.solver));
}

spectral::SpectralPlan plan_of(const Case& c) {
    return spectral::SpectralPlan(c, mesh_of(c), {.step_s = step_s});
}

/// Without the program.
double planned_B(const Case& c, int ranks = 1) {
    return plan_of(c).resources(ranks).memory_per_rank_B() - engines::program_B;
}

spectral::VariationPlan variation_of(const Case& c, int ranks = 1) {
    return plan_of(c).variation(plan_of(c).sampled_variation(), ranks);
}

struct Found {
    bool iterates, uses_box;
};

/// What a stepper does in some steps.
Found found(const Case& c) {
    const Comm alone = Comm::world().split(Comm::world().rank());
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, alone);
    spectral::Stepper stepper(c, mesh_of(c), slabs, step_s, alone);
    for (int n = 0; n < 20; ++n)
        stepper.advance();
    return {stepper.statistics().iterations > 0, stepper.uses_box()};
}

} // namespace

TEST_CASE("iterations and the box are planned where the stepper uses them", "[spectral]") {
    Case c = body_case(GENERATE(1.0, 4.0, 100.0));
    SECTION("unchanged") {}
    SECTION("with one solve per step") {
        std::get<SpectralOptions>(c.solver).method = SpectralMethod::one_solve;
    }
    SECTION("denser") {
        if (!c.scene().medium.bodies.empty()) c.scene().medium.bodies[0].density_kg_m3 = 1900.0;
    }
    const spectral::VariationPlan planned = variation_of(c);
    const Found used = found(c);
    CHECK(planned.iterates == used.iterates);
    CHECK(planned.box.has_value() == used.uses_box);
}

TEST_CASE("the stages allocate the arrays that are planned", "[spectral]") {
    Case c = body_case(GENERATE(1.0, 16.0));
    std::vector<std::string> expected = {"factors", "displacement"};
    SECTION("on planes") {}
    SECTION("in a box") {
        c.domain = {96, 72, 1e-3, 0.0};
        c.time.frames = 100000;
        if (!c.scene().medium.bodies.empty()) {
            c.scene().medium.bodies[0].shape = Ellipsoid{{4e-3, 3e-3, 2e-3}};
            expected.emplace_back("box of elastic bodies");
        }
    }
    SECTION("with a sponge") {
        c.domain.sponge_m = 6e-3;
        expected.emplace_back("sponge");
    }
    SECTION("with a rigid cylinder") {
        c.scene().medium.bodies = {{.name = "bone",
                                    .shape = Cylinder{.radius_m = 2e-3, .azimuth_deg = 90.0},
                                    .centre_m = {0.0, 0.0, 4e-3},
                                    .density_kg_m3 = 1900.0,
                                    .rigid = true}};
        expected.emplace_back("endless rigid bodies");
    }
    SECTION("with a rigid lump") {
        c.scene().medium.bodies = {{.name = "lump",
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
    for (const engines::Array& array : stepper.arrays()) {
        if (array.bytes == 0.0) continue;
        found.push_back(array.name);
        double planned = 0.0;
        for (const engines::Array& other : plan_of(c).resources(1).arrays)
            if (other.name == array.name) planned = other.bytes;
        INFO(array.name);
        CHECK(planned == Approx(array.bytes).epsilon(0.1)); // what plan promises
    }
    for (const std::string& name : expected)
        CHECK(std::count(found.begin(), found.end(), name) == 1);
}

TEST_CASE("the kind of work distinguishes what makes steps longer", "[spectral]") {
    const auto work = [](const Case& c) { return plan_of(c).work(); };
    const Case none = body_case(1.0), stiff = body_case(16.0);
    CHECK(work(none).kind == "spectral");
    CHECK(work(stiff).kind != work(none).kind);
    CHECK(work(stiff).kind != work(body_case(4.0)).kind); // takes other iterations
    CHECK(work(stiff).kind == work(body_case(16.0)).kind);
    CHECK(work(stiff).kind.starts_with("spectral bodies #"));

    Case longer = stiff;
    longer.time.frames *= 10;
    CHECK(work(longer).kind == work(stiff).kind);
    CHECK(work(longer).steps == 10.0 * work(stiff).steps);
    CHECK(work(longer).unknowns == work(stiff).unknowns);

    Case kept = stiff;
    kept.record.volumes_s = {kept.time.frame_s(9)};
    kept.record.volume_fields = {VolumeField::u};
    CHECK(work(kept).snapshots == 1.0);
    CHECK(work(kept).kind != work(stiff).kind);
    Case stress = kept;
    stress.record.volume_fields = {VolumeField::stress};
    CHECK(work(stress).values == 2.0 * work(kept).values);
    CHECK(planned_B(stress) > planned_B(kept));
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
    c.scene().medium.map = map;
    const spectral::VariationPlan v = variation_of(c);
    CHECK(v.iterates); // the last point of the map is found
    CHECK(v.points >= 3.0);
    CHECK(v.cells < v.points * 17 * 17); // one of eight points of the map differs
}

} // namespace test_spectral_plan
