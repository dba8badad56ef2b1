// SPDX-License-Identifier: BSD-3-Clause
// Rigid bodies of any shape in engine "spectral": energy, symmetries, places, and the response of a
// free body over the band of haptic vibrations.
#include "support/memory_state.hpp"
#include "support/rigid_cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace shearwake;
using test::last_frame;
using test::lump_case;
using test::relative_l2;
using test::step_through;

namespace {

Body with_shape(Body body, decltype(Body::shape) shape) {
    body.shape = shape;
    return body;
}

} // namespace

TEST_CASE("energy of a lossless medium with a rigid lump is conserved", "[verify]") {
    const double step_s = GENERATE(25e-6, 50e-6, 200e-6);
    Case c = test::with_step(lump_case(0.0), step_s);
    Body& body = c.scene().medium.bodies[0];
    SECTION("free and dense") {}
    SECTION("free and light") {
        body.density_kg_m3 = 300.0;
    }
    SECTION("free and almost without mass: the tissue around it has enough") {
        body.density_kg_m3 = 1.0;
    }
    SECTION("fixed") {
        body.fixed = true;
    }
    SECTION("two bodies of other shapes") {
        body =
            with_shape(body, Cylinder{.radius_m = 2.6e-3, .length_m = 9e-3, .azimuth_deg = 30.0});
        body.centre_m = {-6e-3, 0.0, 6e-3};
        Body other = with_shape(body, Box{{5e-3, 6e-3, 4e-3}});
        other.centre_m = {6e-3, 1e-3, 5e-3};
        c.scene().medium.bodies.push_back(other);
    }
    SECTION("next to a body across the domain and a complete layer") {
        Body bone = with_shape(body, Cylinder{.radius_m = 1.4e-3, .azimuth_deg = 90.0});
        bone.centre_m = {-11e-3, 0.0, 5e-3};
        Body slab = test::rigid_slab(c);
        slab.shape = Box{{1.0, 1.0, 1.5e-3}};
        slab.centre_m.z = 10.5e-3;
        c.scene().medium.bodies.insert(c.scene().medium.bodies.begin(), {slab, bone});
    }
    SECTION("next to an elastic body, with iterations") {
        if (step_s < 200e-6) return; // many steps, while the long one iterates most
        c.scene().medium.bodies.push_back(test::elastic_neighbour());
        std::get<SpectralOptions>(c.solver).residual = 1e-12; // its error accumulates
    }
    test::check_conserved_energy(c, step_s, 17);
}

TEST_CASE("mirror image of a rigid lump yields the mirror image of the field", "[verify]") {
    Case c = lump_case(0.5);
    Body& body = c.scene().medium.bodies[0];
    SECTION("ellipsoid") {}
    SECTION("upright cylinder") {
        body.shape = Cylinder{.radius_m = 3e-3, .length_m = 6e-3, .axis = CylinderAxis::vertical};
    }
    SECTION("oblique cylinder") {
        body.shape = Cylinder{.radius_m = 3e-3, .length_m = 9e-3, .azimuth_deg = 30.0};
    }
    SECTION("oblique cylinder across the domain") {
        body.shape = Cylinder{.radius_m = 3e-3, .azimuth_deg = 30.0};
    }
    SECTION("box") {
        body.shape = Box{{6e-3, 7e-3, 5e-3}};
    }
    const auto frame = last_frame(c);
    std::get<Travel>(c.scene().load.modulation.trajectory.parts[0]).path =
        Curve({7e-3, 2e-3}, {-7e-3, 1e-3});
    body.centre_m.x *= -1.0;
    if (auto* cylinder = std::get_if<Cylinder>(&body.shape)) cylinder->azimuth_deg *= -1.0;
    const auto mirrored = last_frame(c);
    double worst = 0.0;
    for (std::ptrdiff_t i = 1; i < c.domain.nx; ++i)
        for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j) {
            const auto at = [&](std::ptrdiff_t x) {
                return static_cast<std::size_t>(x * c.domain.ny + j);
            };
            worst = std::max(worst, std::abs(frame[at(i)] - mirrored[at(c.domain.nx - i)]));
        }
    CHECK(worst < 1e-10 * test::largest(frame)); // required
}

TEST_CASE("a rigid lump across the periodic edge is the same body elsewhere", "[verify]") {
    Case c = lump_case(0.5);
    const auto frame = last_frame(c);
    const std::ptrdiff_t shift_x = c.domain.nx / 2 - 1, shift_y = c.domain.ny / 2 - 2;
    const Vec2 by{static_cast<double>(shift_x) * c.domain.spacing_m,
                  static_cast<double>(shift_y) * c.domain.spacing_m};
    std::get<Travel>(c.scene().load.modulation.trajectory.parts[0]).path =
        Curve({-7e-3 + by.x, 2e-3 + by.y}, {7e-3 + by.x, 1e-3 + by.y});
    Vec3& centre = c.scene().medium.bodies[0].centre_m;
    centre = centre + Vec3{by.x, by.y, 0.0};
    const auto moved = last_frame(c);
    double worst = 0.0;
    for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i)
        for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j)
            worst = std::max(
                worst,
                std::abs(frame[static_cast<std::size_t>(i * c.domain.ny + j)] -
                         moved[static_cast<std::size_t>((i + shift_x) % c.domain.nx * c.domain.ny +
                                                        (j + shift_y) % c.domain.ny)]));
    CHECK(worst < 1e-10 * test::largest(frame)); // rounding
}

TEST_CASE("a long rigid lump approaches an endless body", "[verify]") {
    // A cylinder along y that ends half a spacing from the edges, so that its markers are
    // everywhere as far apart as the smoothing of either kind of marker.
    Case c = test::bone_case(test::Along::y, 0.5);
    const auto endless = last_frame(c);
    auto& cylinder = std::get<Cylinder>(c.scene().medium.bodies[0].shape);
    cylinder.length_m = c.domain.extent_y_m() - 0.5 * c.domain.spacing_m;
    const auto lump = last_frame(c);
    c.scene().medium.bodies.clear();
    const auto without = last_frame(c);
    std::vector<double> of_endless, of_lump;
    for (std::size_t i = 0; i < without.size(); ++i) {
        of_endless.push_back(endless[i] - without[i]);
        of_lump.push_back(lump[i] - without[i]);
    }
    const double difference = relative_l2(of_lump, of_endless);
    CAPTURE(difference, relative_l2(without, endless));
    CHECK(difference < 0.05); // 2.4 spacings per radius
}

TEST_CASE("a restored run with a rigid lump continues with the same bits", "[verify]") {
    const Case c = lump_case(0.5);
    test::MemoryState saved, end;
    step_through(c, 12, [&](spectral::Stepper& stepper) {
        if (stepper.step() == 6) stepper.save(saved);
        if (stepper.step() == 12) stepper.save(end);
    });
    const Comm alone = Comm::world().split(Comm::world().rank());
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, alone);
    const auto& options = std::get<SpectralOptions>(c.solver);
    spectral::Stepper stepper(c, spectral::choose_mesh(c, options, *options.time_step_s), slabs,
                              *options.time_step_s, alone);
    stepper.restore(saved);
    while (stepper.step() < 12)
        stepper.advance();
    test::MemoryState restored;
    stepper.save(restored);
    CHECK(restored == end);
}
