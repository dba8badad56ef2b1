// SPDX-License-Identifier: BSD-3-Clause
// Compares results of engine pstd on any number of ranks and after a stop.
#include "support/stop_at.hpp"
#include "support/volume_store.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>

namespace test_pstd_engine {

using namespace shearwake;

/// A moving focus over a film with an inclusion below, for 1 ms; the extents have few divisors.
static Case small_case(PstdEdges edges) {
    Case c = test::moving_focus(test::half_space(test::tissue(50.0, 0.2)), ConstantSpeed{7.0});
    Layer film = c.scene.medium.layers[0];
    film.thickness_m = 1.7e-3;
    film.c_s_m_s = 8.0;
    c.scene.medium.layers.insert(c.scene.medium.layers.begin(), film);
    Body lump;
    lump.shape = Ellipsoid{{3e-3, 2e-3, 2e-3}};
    lump.centre_m = {1e-3, -2e-3, 5e-3};
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
    options.edges = edges;
    c.solver = options;
    return c;
}

/// Largest difference of frames (beginning with `from`) and volumes to those of the complete run on
/// one rank, relative to the largest value of each.
static double apart(const Case& c, const test::VolumeStore& part, const test::VolumeStore& whole,
                    std::ptrdiff_t from, const Comm& world) {
    double worst = 0.0;
    const auto offset = static_cast<std::size_t>(part.slab().x_start * c.domain.ny);
    const auto compare = [&](const std::vector<double>& a, const std::vector<double>& b) {
        worst = test::worse(worst, test::apart(a, b, offset));
    };
    for (std::size_t depth = 0; depth < c.measure.depths_m.size(); ++depth)
        for (std::ptrdiff_t n = from; n < c.time.frames; ++n)
            compare(part.FrameStore::at(n, depth), whole.FrameStore::at(n, depth));
    for (std::size_t component = 0; component < 3; ++component)
        for (std::size_t level = 0; level < whole.z_m().size(); ++level)
            compare(part.at(1, 0, component, level), whole.at(1, 0, component, level));
    return world.max(worst);
}

TEST_CASE("fields of engine pstd are identical on any number of ranks", "[mpi][pstd]") {
    const Comm world = Comm::world(), alone = world.split(world.rank());
    const Case c = small_case(GENERATE(PstdEdges::periodic, PstdEdges::absorbing));
    test::VolumeStore shared, single;
    engines::make_engine(c.solver)->run(c, world, shared);
    engines::make_engine(c.solver)->run(c, alone, single);
    CHECK(single.z_m().size() > 5);
    // Exactly equal: every line uses the same plan on any rank.
    const double worst = apart(c, shared, single, 0, world);
    CHECK(worst == 0.0);
}

TEST_CASE("ranks without planes do not affect engine pstd on any number of ranks", "[mpi][pstd]") {
    const Comm world = Comm::world(), alone = world.split(world.rank());
    Case c = small_case(PstdEdges::periodic);
    c.domain.nx = 1; // only one rank has a plane
    test::VolumeStore shared, single;
    engines::make_engine(c.solver)->run(c, world, shared);
    engines::make_engine(c.solver)->run(c, alone, single);
    const double worst = apart(c, shared, single, 0, world);
    CHECK(worst == 0.0);
}

TEST_CASE("engine pstd resumes a stopped case with the same bits", "[mpi][pstd]") {
    const Comm world = Comm::world(), alone = world.split(world.rank());
    const Case c = small_case(PstdEdges::periodic);
    test::VolumeStore whole, first, second;
    engines::make_engine(c.solver)->run(c, alone, whole);
    test::StopAt checkpoints(60);
    engines::make_engine(c.solver)->run(c, world, first, &checkpoints);
    CHECK(first.planes() < whole.planes());
    engines::make_engine(c.solver)->run(c, world, second, &checkpoints);
    const double worst = apart(c, second, whole, 3, world);
    CHECK(worst == 0.0);
}

} // namespace test_pstd_engine
