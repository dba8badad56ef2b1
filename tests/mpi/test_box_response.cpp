// SPDX-License-Identifier: BSD-3-Clause
// Iterations on a box around elastic bodies: the same field as with iterations on complete planes.
#include "engines/spectral/stepping/stepper.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "support/spectral_cases.hpp"

#include <catch2/catch.hpp>

namespace test_box_response {

using namespace shearwake;

/// The first steps of a run of `frames` frames.
struct Start {
    fft::AlignedVector<double> plane; // u_z of the surface, this rank's part
    bool box;
};
static Start start_of(Case c, std::ptrdiff_t frames, const Comm& team) {
    c.time.frames = frames;
    const auto& options = std::get<SpectralOptions>(c.solver);
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, team);
    spectral::Stepper stepper(c, spectral::choose_mesh(c, options), slabs, *options.time_step_s,
                              team);
    for (int step = 0; step < 4; ++step)
        stepper.advance();
    Start start{.plane = fft::AlignedVector<double>(static_cast<std::size_t>(slabs.share().reals)),
                .box = stepper.box().has_value()};
    stepper.plane_of_w(0.0, start.plane.data());
    return start;
}

TEST_CASE("iterations on a box yield the field of iterations on planes", "[mpi]") {
    Case c = test::small_tissue();
    c.domain = {48, 32, 1e-3, 0.0};
    test::travel_of(c).path = {{-3e-3, 1e-3}, {10e-3, 3e-3}};
    SpectralOptions options;
    options.time_step_s = 50e-6;
    options.residual = 1e-11;
    options.method = SpectralMethod::iterative;
    c.solver = options;
    Body body = test::small_body(16.0);
    body.shape = Ellipsoid{{4e-3, 2e-3, 1.5e-3}};
    SECTION("stiffer") {}
    SECTION("denser and more viscous, so that the displacement takes part") {
        body.density_kg_m3 = 1700.0;
        body.viscosity_Pa_s = 2.0;
    }
    SECTION("across the domain, so that the box is as long as the plane") {
        body.shape = Cylinder{.radius_m = 1.5e-3};
    }
    c.scene.medium.bodies = {body};
    const Comm world = Comm::world();
    const Start plane = start_of(c, 4, world), box = start_of(c, 100000, world);
    REQUIRE_FALSE(plane.box); // too few steps
    REQUIRE(box.box);
    test::Deviation difference;
    difference.add(box.plane, plane.plane);
    // The box is exact; the residual of the iterations remains.
    CHECK(difference.relative(world) < 1e-9);
}

} // namespace test_box_response
