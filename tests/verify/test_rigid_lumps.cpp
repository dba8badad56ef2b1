// SPDX-License-Identifier: BSD-3-Clause
// Rigid bodies of any shape in engine "spectral": energy, symmetries and places.
#include "support/rigid_cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_rigid_lumps {

using namespace shearwake;
using test::last_frame;
using test::lump_case;
using test::relative_l2;

static Body with_shape(Body body, decltype(Body::shape) shape) {
    body.shape = shape;
    return body;
}

TEST_CASE("energy of a lossless medium with rigid lumps is conserved", "[verify][extended]") {
    const double step_s = GENERATE(50e-6, 200e-6);
    Case c = test::with_step(lump_case(0.0), step_s);
    SECTION("free and fixed, of several shapes and densities") {
        const Body body = c.scene.medium.bodies[0];
        Body dense =
            with_shape(body, Cylinder{.radius_m = 2.6e-3, .length_m = 9e-3, .azimuth_deg = 30.0});
        dense.centre_m = {-7.3e-3, -7.1e-3, 6e-3};
        Body light = body;
        light.centre_m = {7.4e-3, -6.9e-3, 5e-3};
        light.density_kg_m3 = 300.0;
        Body fixed = with_shape(body, Box{{5e-3, 6e-3, 4e-3}});
        fixed.centre_m = {7e-3, 7e-3, 5e-3};
        fixed.fixed = true;
        c.scene.medium.bodies = {dense, light, fixed};
    }
    SECTION("free and almost without mass: the tissue around it has enough") {
        c.scene.medium.bodies[0].density_kg_m3 = 1.0;
    }
    SECTION("free and light, at different depths, between which elements are short") {
        Body upper = with_shape(c.scene.medium.bodies[0], Ellipsoid{{5e-3, 4e-3, 1.75e-3}});
        upper.centre_m = {5.3e-3, 4.7e-3, 3.25e-3}; // down to 5 mm
        upper.density_kg_m3 = 1.0;
        Body lower = with_shape(upper, Ellipsoid{{4e-3, 4e-3, 2.2e-3}});
        lower.centre_m = {-5.7e-3, -5.1e-3, 6.9e-3}; // from 4.7 mm on
        lower.density_kg_m3 = 300.0;
        c.scene.medium.bodies = {upper, lower};
    }
    SECTION("across the interface of two layers") {
        std::vector<Layer>& layers = c.scene.medium.layers;
        Layer lower = layers.back();
        lower.c_s_m_s *= 1.6;
        lower.density_kg_m3 *= 1.1;
        const double middle_m = c.scene.medium.bodies[0].centre_m.z;
        lower.thickness_m = layers.back().thickness_m - middle_m;
        layers.back().thickness_m = middle_m;
        REQUIRE(layers.size() == 1);
        REQUIRE(lower.thickness_m > 0.0);
        layers.push_back(lower);
    }
    SECTION("next to a body across the domain and a complete layer") {
        Body bone =
            with_shape(c.scene.medium.bodies[0], Cylinder{.radius_m = 1.4e-3, .azimuth_deg = 90});
        bone.centre_m = {-11e-3, 0.0, 5e-3};
        Body slab = test::rigid_slab(c);
        slab.shape = Box{{1.0, 1.0, 1.5e-3}};
        slab.centre_m.z = 10.5e-3;
        c.scene.medium.bodies.insert(c.scene.medium.bodies.begin(), {slab, bone});
    }
    SECTION("next to an elastic body, with iterations") {
        // Many steps, while the long one iterates most.
        if (step_s != 200e-6 || !test::is_long_form()) return;
        c.scene.medium.bodies.push_back(test::elastic_neighbour());
        std::get<SpectralOptions>(c.solver).residual = 1e-12; // its error accumulates
    }
    test::check_conserved_energy(c, step_s, 17);
}

TEST_CASE("mirror image of rigid lumps yields the mirror image of the field",
          "[verify][extended]") {
    Case c = lump_case(0.5);
    std::vector<Body>& bodies = c.scene.medium.bodies;
    const Body body = bodies[0];
    SECTION("an ellipsoid, an upright and an oblique cylinder, and a box") {
        if (!test::is_long_form()) return;
        bodies[0].centre_m = {-7.3e-3, -7.1e-3, 6e-3};
        Body upright = with_shape(
            body, Cylinder{.radius_m = 3e-3, .length_m = 6e-3, .axis = CylinderAxis::vertical});
        upright.centre_m = {7.4e-3, -6.9e-3, 5e-3};
        Body oblique =
            with_shape(body, Cylinder{.radius_m = 3e-3, .length_m = 9e-3, .azimuth_deg = 30.0});
        oblique.centre_m = {-7.1e-3, 7.6e-3, 6.5e-3};
        Body box = with_shape(body, Box{{6e-3, 7e-3, 5e-3}});
        box.centre_m = {7e-3, 7e-3, 5e-3};
        bodies.insert(bodies.end(), {upright, oblique, box});
    }
    SECTION("an oblique cylinder across the domain") {
        bodies[0].shape = Cylinder{.radius_m = 3e-3, .azimuth_deg = 30.0};
    }
    const auto frame = last_frame(c);
    test::travel_of(c).path = Curve({7e-3, 2e-3}, {-7e-3, 1e-3});
    for (Body& mirrored : bodies) {
        mirrored.centre_m.x *= -1.0;
        if (auto* cylinder = std::get_if<Cylinder>(&mirrored.shape)) cylinder->azimuth_deg *= -1.0;
    }
    const auto mirrored = last_frame(c);
    CHECK(test::asymmetry(c.domain, frame, mirrored) < 1e-10 * test::largest(frame)); // required
}

TEST_CASE("a rigid lump across the periodic edge is the same body elsewhere", "[verify]") {
    Case c = lump_case(0.5);
    const auto frame = last_frame(c);
    const std::ptrdiff_t shift_x = c.domain.nx / 2 - 1, shift_y = c.domain.ny / 2 - 2;
    const Vec2 by{static_cast<double>(shift_x) * c.domain.spacing_m,
                  static_cast<double>(shift_y) * c.domain.spacing_m};
    test::travel_of(c).path = Curve({-7e-3 + by.x, 2e-3 + by.y}, {7e-3 + by.x, 1e-3 + by.y});
    Vec3& centre = c.scene.medium.bodies[0].centre_m;
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
    auto& cylinder = std::get<Cylinder>(c.scene.medium.bodies[0].shape);
    cylinder.length_m = c.domain.extent_y_m() - 0.5 * c.domain.spacing_m;
    const auto lump = last_frame(c);
    c.scene.medium.bodies.clear();
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

} // namespace test_rigid_lumps
