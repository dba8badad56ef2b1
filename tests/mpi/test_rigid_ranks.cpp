// SPDX-License-Identifier: BSD-3-Clause
// Rigid bodies in engine "spectral" on several ranks.
#include "support/gathered_state.hpp"
#include "support/rigid_cases.hpp"

#include <catch2/catch.hpp>

namespace test_rigid_ranks {

using namespace shearwake;

static spectral::Stepper stepper_of(const Case& c, const fft::SlabTransform& slabs,
                                    const Comm& team) {
    const auto& options = std::get<SpectralOptions>(c.solver);
    const spectral::RigidPlan plan(c);
    return {plan, spectral::choose_mesh(plan.c, options, *options.time_step_s), slabs,
            *options.time_step_s, team};
}

static void advance_to(std::ptrdiff_t step, spectral::Stepper& stepper) {
    while (stepper.step() < step)
        stepper.advance();
}

struct Ended {
    std::vector<double> plane; // u_z of the surface, this rank's part
    std::vector<double> position;
    std::ptrdiff_t x_start = 0;
};
static Ended end_of(const Case& c, const Comm& team) {
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, team);
    spectral::Stepper stepper = stepper_of(c, slabs, team);
    advance_to(12, stepper);
    const fft::SlabShare& share = slabs.share();
    fft::AlignedVector<double> padded(static_cast<std::size_t>(share.reals));
    stepper.plane_of_w(0.0, padded.data());
    slabs.to_physical(padded.data());
    Ended ended{.plane = {}, .position = stepper.bodies().position(), .x_start = share.x_start};
    for (std::ptrdiff_t i = 0; i < share.x_count; ++i) {
        const double* row = padded.data() + i * share.padded_ny;
        ended.plane.insert(ended.plane.end(), row, row + c.domain.ny);
    }
    return ended;
}

TEST_CASE("rigid bodies move alike on any number of ranks", "[mpi]") {
    Case c = test::bone_case(test::Along::y, 0.5);
    Body& body = c.scene.medium.bodies[0];
    SECTION("across the domain") {}
    SECTION("across the domain along x, into the sponge") {
        c = test::bone_case(test::Along::x, 0.5);
        c.domain.sponge_m = 6e-3;
    }
    SECTION("two lumps, one of them across the periodic edge") {
        body.shape = Cylinder{.radius_m = 2.4e-3, .length_m = 7e-3, .azimuth_deg = 30.0};
        Body other = body;
        other.shape = shearwake::Box{{4e-3, 4e-3, 3e-3}};
        other.centre_m = {-19e-3, 1e-3, 5e-3};
        c.scene.medium.bodies.push_back(other);
    }
    SECTION("a lump next to a body across the domain and a complete layer") {
        Body lump = body;
        lump.shape = Ellipsoid{{4e-3, 3e-3, 2e-3}};
        lump.centre_m = {-9e-3, 1e-3, 4e-3};
        Body slab = test::rigid_slab(c);
        slab.shape = shearwake::Box{{1.0, 1.0, 1.5e-3}};
        slab.centre_m.z = 10.5e-3;
        c.scene.medium.bodies.push_back(lump);
        c.scene.medium.bodies.push_back(slab);
    }
    const Comm world = Comm::world();
    const Ended together = end_of(c, world);
    Ended alone;
    test::on_root_alone(world, [&](const Comm& team) { alone = end_of(c, team); });
    world.broadcast(alone.plane);
    world.broadcast(alone.position);
    test::Deviation plane;
    plane.add(together.plane, alone.plane,
              static_cast<std::size_t>(together.x_start * c.domain.ny));
    CHECK(plane.relative(world) < 1e-12); // required
    REQUIRE(together.position.size() == alone.position.size());
    CHECK(test::apart(together.position, alone.position) < 1e-12);
}

TEST_CASE("rigid bodies resume from a checkpoint on any number of ranks", "[mpi]") {
    Case c = GENERATE(test::bone_case(test::Along::x, 0.5), test::bone_case(test::Along::y, 0.5),
                      test::lump_case(0.5));
    c.domain.sponge_m = 6e-3;
    const Comm world = Comm::world();
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, world);
    spectral::Stepper together = stepper_of(c, slabs, world);
    test::GatheredState half(world), end(world);
    advance_to(6, together);
    together.save(half);
    advance_to(12, together);
    together.save(end);
    // On one rank, and from there on all ranks again.
    const Comm alone = world.split(world.rank());
    const fft::SlabTransform whole(c.domain.nx, c.domain.ny, alone);
    spectral::Stepper single = stepper_of(c, whole, alone), again = stepper_of(c, slabs, world);
    test::GatheredState later(alone), by_one(alone), by_all(world);
    single.restore(half);
    advance_to(9, single);
    single.save(later);
    advance_to(12, single);
    single.save(by_one);
    again.restore(later);
    advance_to(12, again);
    again.save(by_all);
    for (const char* name : {"now", "before", "rigid_bodies"})
        for (test::GatheredState* found : {&by_one, &by_all}) {
            CAPTURE(name, found == &by_one);
            REQUIRE(found->rows(name).size() == end.rows(name).size());
            // On several ranks the order of sums differs.
            CHECK(test::apart(found->rows(name), end.rows(name)) <=
                  (world.size() == 1 ? 0.0 : 1e-12));
        }
}

} // namespace test_rigid_ranks
