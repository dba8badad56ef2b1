#include "engines/spectral/spectral_estimate.hpp"
#include "engines/spectral/stepper.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>

using namespace shearwake;

namespace {

constexpr double step_s = 50e-6;

/// A body of that stiffness, or none at 1, under a 3 mm focus: 48 x 36 points, two elements.
Case body_case(double contrast) {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0, 1.0)), ConstantSpeed{7.0});
    c.medium.base = Base::rigid;
    c.medium.layers[0].thickness_m = 8e-3;
    std::get<Travel>(c.load.modulation.trajectory.parts[0]).path = {{-6e-3, 0.0}, {200e-3, 0.0}};
    if (contrast != 1.0)
        c.medium.bodies = {{.name = "body",
                            .shape = Ellipsoid{{9e-3, 6e-3, 2e-3}},
                            .centre_m = {0.0, 2e-3, 3.5e-3},
                            .c_s_m_s = 5.0 * std::sqrt(contrast)}};
    c.domain = {48, 36, 1e-3, 0.0};
    c.time = {20, step_s};
    c.solver = SpectralOptions{.time_step_s = step_s};
    return c;
}

DepthMesh mesh_of(const Case& c) {
    return choose_mesh(c, std::get<SpectralOptions>(c.solver));
}

Estimate estimate(const Case& c, int ranks = 1) {
    return estimate_spectral(c, mesh_of(c), 1, ranks);
}

double iterations(const Case& c) {
    return estimate_variation(c, mesh_of(c), step_s, 1).iterations;
}

struct Found {
    double memory_B, iterations;
};

/// Of the true stepper after some steps.
Found counted(const Case& c, int steps) {
    const Comm alone = Comm::world().split(Comm::world().rank());
    const SlabTransform slabs(c.domain.nx, c.domain.ny, alone);
    Stepper stepper(c, mesh_of(c), slabs, step_s, alone);
    for (int n = 0; n < steps; ++n)
        stepper.advance();
    return {stepper.memory_B(), static_cast<double>(stepper.statistics().iterations) / steps};
}

} // namespace

TEST_CASE("the estimated memory is that of the stepper's arrays", "[spectral]") {
    Case c = body_case(GENERATE(1.0, 2.0, 16.0));
    SECTION("as it is") {}
    SECTION("with a sponge") {
        c.domain.sponge_m = 6e-3;
    }
    SECTION("a soft, light body, beside which all of the plane is kept") {
        if (c.medium.bodies.empty()) return;
        c.medium.bodies[0].c_s_m_s = 3.0;
        c.medium.bodies[0].density_kg_m3 = 900.0;
    }
    // The boxes around bodies and the engine's planes are in it, vectors' spare room is not.
    CHECK(estimate(c).memory_per_rank_B - program_B == Approx(counted(c, 0).memory_B).epsilon(0.3));
}

TEST_CASE("the estimated iterations are within a factor of three", "[spectral]") {
    Case c = body_case(GENERATE(4.0, 16.0, 100.0));
    SECTION("stiffer") {}
    SECTION("stiffer and without loss") {
        c.medium.bodies[0].viscosity_Pa_s = 0.0;
    }
    SECTION("stiffer and denser") {
        c.medium.bodies[0].density_kg_m3 = 1900.0;
    }
    const double found = counted(c, 5).iterations;
    CHECK(iterations(c) > found / 3.0);
    CHECK(iterations(c) < found * 3.0);
}

TEST_CASE("one solve a step needs no iterations", "[spectral]") {
    Case c = body_case(16.0);
    std::get<SpectralOptions>(c.solver).method = SpectralMethod::one_solve;
    CHECK(iterations(c) == 0.0);
    CHECK(counted(c, 2).iterations == 0.0);
}

TEST_CASE("estimated seconds grow with what there is to do", "[spectral]") {
    const double none = estimate(body_case(1.0)).seconds;
    const double stiff = estimate(body_case(16.0)).seconds;
    CHECK(stiff > 3.0 * none); // iterations, and six planes at half the nodes
    CHECK(estimate(body_case(100.0)).seconds > stiff);

    Case longer = body_case(16.0);
    longer.time.frames *= 10;
    CHECK(estimate(longer).seconds > 5.0 * stiff);

    Case kept = body_case(16.0);
    kept.record.volumes_s = {kept.time.frame_s(9)};
    kept.record.volume_fields = {VolumeField::u};
    CHECK(estimate(kept).seconds > stiff);
    Case stress = kept;
    stress.record.volume_fields = {VolumeField::stress};
    CHECK(estimate(stress).seconds > estimate(kept).seconds);
    CHECK(estimate(stress).memory_per_rank_B > estimate(kept).memory_per_rank_B);
}

TEST_CASE("more ranks hold less each, the rank above a body most", "[spectral]") {
    const Case c = body_case(16.0);
    const double one = estimate(c, 1).memory_per_rank_B - program_B;
    const double four = estimate(c, 4).memory_per_rank_B - program_B;
    CHECK(four > one / 4.0);
    CHECK(four < one / 2.0); // ky of 19 share out as 5, lanes of 8 as they are
    const DepthMesh mesh = mesh_of(c);
    const VariationEstimate v = estimate_variation(c, mesh, step_s, 4);
    CHECK(v.fullest_cells > 0.25 * v.cells);
    CHECK(v.fullest_cells <= v.cells);
}

TEST_CASE("a map counts as far as it reaches", "[spectral]") {
    Case c = body_case(1.0);
    auto map = std::make_shared<MaterialMap>();
    map->counts = {2, 2, 2};
    map->origin_m = {-4e-3, -4e-3, 1e-3};
    map->spacing_m = {8e-3, 8e-3, 1e-3};
    map->c_s_m_s = {5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 20.0};
    map->content_hash = hash_of(*map);
    c.medium.map = map;
    const VariationEstimate v = estimate_variation(c, mesh_of(c), step_s, 1);
    CHECK(v.iterations > 1.0); // the last point is seen
    // 17 x 17 cells at each point of the first element that the depths 0.5 to 2.5 mm meet.
    CHECK(v.points >= 3.0);
    CHECK(v.cells == Approx(v.points * 17 * 17));
    CHECK(estimate(c).seconds > estimate(body_case(1.0)).seconds);
}
