// SPDX-License-Identifier: BSD-3-Clause
// Rigid bodies in engine "spectral" on several ranks.
#include "support/gathered_state.hpp"
#include "support/on_root.hpp"
#include "support/rigid_cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_rigid_ranks {

using namespace shearwake;

namespace {

struct Ended {
    std::vector<double> plane; // u_z of the surface, this rank's part
    fft::SlabShare share;
    std::vector<double> position;
};
Ended end_of(const Case& c, const Comm& team) {
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, team);
    const auto& options = std::get<SpectralOptions>(c.solver);
    spectral::Stepper stepper(c, spectral::choose_mesh(c, options, *options.time_step_s), slabs,
                              *options.time_step_s, team);
    while (stepper.step() < 12)
        stepper.advance();
    fft::AlignedVector<double> plane(static_cast<std::size_t>(slabs.share().reals));
    stepper.plane_of_w(0.0, plane.data());
    slabs.to_physical(plane.data());
    return {.plane = {plane.begin(), plane.end()},
            .share = slabs.share(),
            .position = stepper.bodies().position()};
}

} // namespace

TEST_CASE("rigid bodies move alike on any number of ranks", "[mpi]") {
    Case c = test::bone_case(test::Along::y, 0.5);
    Body& body = c.scene().medium.bodies[0];
    SECTION("across the domain") {}
    SECTION("two lumps, one of them across the periodic edge") {
        body.shape = Cylinder{.radius_m = 2.4e-3, .length_m = 7e-3, .azimuth_deg = 30.0};
        Body other = body;
        other.shape = shearwake::Box{{4e-3, 4e-3, 3e-3}};
        other.centre_m = {-19e-3, 1e-3, 5e-3};
        c.scene().medium.bodies.push_back(other);
    }
    SECTION("a lump next to a body across the domain and a complete layer") {
        Body lump = body;
        lump.shape = Ellipsoid{{4e-3, 3e-3, 2e-3}};
        lump.centre_m = {-9e-3, 1e-3, 4e-3};
        Body slab = test::rigid_slab(c);
        slab.shape = shearwake::Box{{1.0, 1.0, 1.5e-3}};
        slab.centre_m.z = 10.5e-3;
        c.scene().medium.bodies.push_back(lump);
        c.scene().medium.bodies.push_back(slab);
    }
    const Comm world = Comm::world();
    const Ended together = end_of(c, world);
    Ended alone;
    test::on_root_alone(world, [&](const Comm& team) { alone = end_of(c, team); });
    alone.share.padded_ny = world.broadcast(alone.share.padded_ny);
    world.broadcast(alone.plane);
    world.broadcast(alone.position);
    double difference = 0.0, largest = 0.0;
    for (std::ptrdiff_t i = 0; i < together.share.x_count; ++i)
        for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j) {
            const auto at = static_cast<std::size_t>(i * together.share.padded_ny + j);
            const auto there =
                static_cast<std::size_t>((together.share.x_start + i) * alone.share.padded_ny + j);
            difference = std::max(difference, std::abs(together.plane[at] - alone.plane[there]));
            largest = std::max(largest, std::abs(alone.plane[there]));
        }
    CHECK(world.max(difference) < 1e-12 * world.max(largest)); // required
    double farthest = 0.0, apart = 0.0;
    for (std::size_t i = 0; i < alone.position.size(); ++i) {
        apart = std::max(apart, std::abs(together.position[i] - alone.position[i]));
        farthest = std::max(farthest, std::abs(alone.position[i]));
    }
    CHECK(farthest > 0.0);
    CHECK(apart < 1e-12 * farthest);
}

TEST_CASE("rigid bodies resume from a checkpoint on any number of ranks", "[mpi]") {
    const Case c = GENERATE(test::bone_case(test::Along::x, 0.5), test::lump_case(0.5));
    const Comm world = Comm::world();
    const auto& options = std::get<SpectralOptions>(c.solver);
    const auto mesh = spectral::choose_mesh(c, options, *options.time_step_s);
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, world);
    spectral::Stepper together(c, mesh, slabs, *options.time_step_s, world);
    test::GatheredState half(world), end(world);
    while (together.step() < 6)
        together.advance();
    together.save(half);
    while (together.step() < 12)
        together.advance();
    together.save(end);
    double worst = 0.0, least = 1.0;
    test::on_root_alone(world, [&](const Comm& alone) {
        const fft::SlabTransform whole(c.domain.nx, c.domain.ny, alone);
        spectral::Stepper resumed(c, mesh, whole, *options.time_step_s, alone);
        resumed.restore(half);
        while (resumed.step() < 12)
            resumed.advance();
        test::GatheredState other(alone);
        resumed.save(other);
        for (const char* name : {"now", "before", "rigid_bodies"}) {
            const std::vector<double>&expected = end.rows(name), &found = other.rows(name);
            double difference = 0.0, largest = 0.0;
            for (std::size_t i = 0; i < expected.size(); ++i) {
                difference = std::max(difference, std::abs(found[i] - expected[i]));
                largest = std::max(largest, std::abs(expected[i]));
            }
            worst = std::max(worst, difference / largest);
            least = std::min(least, largest);
        }
    });
    CHECK(world.broadcast(least) > 0.0);
    CHECK(world.broadcast(worst) < 1e-12); // sums in a different order
}

} // namespace test_rigid_ranks
