// SPDX-License-Identifier: BSD-3-Clause
// Bodies of any orientation in engine "spectral".
#include "base/field.hpp"
#include "support/rigid_cases.hpp"

#include <catch2/catch.hpp>

namespace test_turned_lumps {

using namespace shearwake;
using test::last_frame;
using test::lump_case;
using test::relative_l2;

static Case with_shapes(Case c, const std::vector<decltype(Body::shape)>& shapes) {
    const Body body = c.scene.medium.bodies[0];
    const std::vector<Vec3> centres_m = {
        {1.3e-3, 0.7e-3, 6e-3}, {-7.3e-3, -7.1e-3, 6e-3}, {7.4e-3, 7.6e-3, 6.2e-3}};
    c.scene.medium.bodies.clear();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        Body next = body;
        next.shape = shapes[i];
        next.centre_m = centres_m[i];
        c.scene.medium.bodies.push_back(next);
    }
    return c;
}

/// The effect of the bodies on the surface, which differs from the field by that without bodies.
static std::vector<double> effect(const Case& c) {
    Case without = c;
    without.scene.medium.bodies.clear();
    std::vector<double> field = last_frame(c);
    const std::vector<double> background = last_frame(without);
    for (std::size_t i = 0; i < field.size(); ++i)
        field[i] -= background[i];
    return field;
}

TEST_CASE("energy of a lossless medium with turned rigid lumps is conserved", "[verify]") {
    const double step_s = GENERATE(50e-6, 200e-6);
    const Case c = with_shapes(
        test::with_step(lump_case(0.0), step_s),
        {Box{{6e-3, 5e-3, 4e-3}, {35.0, 25.0, -20.0}},
         Ellipsoid{{5e-3, 3e-3, 3.5e-3}, {20.0, 50.0}},
         Cylinder{
             .radius_m = 2.6e-3, .length_m = 7e-3, .azimuth_deg = 30.0, .inclination_deg = 40.0}});
    test::check_conserved_energy(c, step_s, 17);
}

TEST_CASE("a rigid box turned by 90 degrees has the field of one with exchanged sizes",
          "[verify]") {
    const Vec3 r{6e-3, 5e-3, 4e-3};
    const auto [turn, size_m] =
        GENERATE_COPY(table<Orientation, Vec3>({{{.azimuth_deg = 90.0}, {r.y, r.x, r.z}},
                                                {{.inclination_deg = 90.0}, {r.z, r.y, r.x}},
                                                {{.roll_deg = -90.0}, {r.x, r.z, r.y}}}));
    const auto turned = last_frame(with_shapes(lump_case(0.5), {Box{r, turn}}));
    const auto plain = last_frame(with_shapes(lump_case(0.5), {Box{size_m}}));
    // The same markers up to rounding, which the inverse of their matrix amplifies.
    CHECK(relative_l2(turned, plain) < 1e-10);
}

TEST_CASE("energy of a lossless medium with a turned elastic body is conserved",
          "[verify][extended]") {
    Case c = test::with_step(lump_case(0.0), 100e-6);
    Body& body = c.scene.medium.bodies[0];
    body.shape = Box{{8e-3, 5e-3, 3e-3}, {35.0, 25.0, -20.0}};
    body.rigid = false;
    body.density_kg_m3 = 1200.0;
    body.c_s_m_s = 10.0;                                  // four times stiffer than the tissue
    std::get<SpectralOptions>(c.solver).residual = 1e-12; // its error accumulates
    test::check_conserved_energy(c, 100e-6, 17);
}

TEST_CASE("a rigid cylinder inclined by 90 degrees has the field of a vertical one",
          "[verify][extended]") {
    const Case inclined = with_shapes(
        lump_case(0.5), {Cylinder{.radius_m = 3e-3, .length_m = 6e-3, .inclination_deg = 90.0}});
    const Case vertical =
        with_shapes(lump_case(0.5),
                    {Cylinder{.radius_m = 3e-3, .length_m = 6e-3, .axis = CylinderAxis::vertical}});
    CHECK(relative_l2(last_frame(inclined), last_frame(vertical)) < 1e-10); // rounding, as above
}

TEST_CASE("the orientation of a rigid sphere has little effect on the field",
          "[verify][extended]") {
    // Only the places of its markers change. At 4.8 spacings per radius, they change the effect of
    // the sphere on the surface by 1 to 2 %; at 2.4, by 20 %.
    Case c = lump_case(0.5);
    c.domain = {48, 48, 0.5 * c.domain.spacing_m, 0.0};
    c.time.frames /= 2;
    const Ellipsoid sphere{{3e-3, 3e-3, 3e-3}};
    Ellipsoid turned = sphere;
    turned.orientation = {30.0, 50.0, 20.0};
    const auto of_sphere = effect(with_shapes(c, {sphere}));
    const auto of_turned = effect(with_shapes(c, {turned}));
    const double difference = relative_l2(of_turned, of_sphere);
    CAPTURE(difference);
    CHECK(difference < 0.04);
}

TEST_CASE("mirror image of turned rigid lumps yields the mirror image of the field", "[verify]") {
    Case c = with_shapes(
        lump_case(0.5),
        {Box{{6e-3, 5e-3, 4e-3}, {35.0, 25.0, -20.0}},
         Ellipsoid{{5e-3, 3e-3, 3.5e-3}, {20.0, 50.0, 10.0}},
         Cylinder{
             .radius_m = 2.6e-3, .length_m = 7e-3, .azimuth_deg = 30.0, .inclination_deg = 40.0}});
    const auto frame = last_frame(c);
    test::travel_of(c).path = Curve({7e-3, 2e-3}, {-7e-3, 1e-3});
    for (Body& mirrored : c.scene.medium.bodies) {
        mirrored.centre_m.x *= -1.0;
        std::visit(overloaded{
                       // These shapes are symmetric about the planes of their own axes.
                       [](Cylinder& shape) { shape.azimuth_deg = 180.0 - shape.azimuth_deg; },
                       [](auto& shape) {
                           shape.orientation.azimuth_deg = 180.0 - shape.orientation.azimuth_deg;
                           shape.orientation.roll_deg *= -1.0;
                       },
                   },
                   mirrored.shape);
    }
    const auto mirrored = last_frame(c);
    CHECK(test::asymmetry(c.domain, frame, mirrored) < 1e-10 * test::largest(frame)); // rounding
}

} // namespace test_turned_lumps
