// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/lump_markers.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"

#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace test_lump_markers {

using namespace shearwake;

static Medium tissue_medium() {
    Medium medium;
    medium.layers = {{.name = "tissue",
                      .thickness_m = 0.02,
                      .density_kg_m3 = 1000.0,
                      .c_p_m_s = 1500.0,
                      .c_s_m_s = 5.0}};
    return medium;
}

/// A box, an ellipsoid and a cylinder that are turned by the same angles.
static std::vector<Body> turned_bodies() {
    const Orientation turn{35.0, -50.0, 20.0}, without_roll{35.0, -50.0, 0.0};
    Body body{.name = "bone", .centre_m = {1.3e-3, -0.7e-3, 9e-3}, .density_kg_m3 = 1900.0};
    std::vector<Body> bodies;
    for (const decltype(Body::shape) shape : {decltype(Body::shape){Box{{9e-3, 6e-3, 5e-3}, turn}},
                                              {Ellipsoid{{6e-3, 4e-3, 3e-3}, without_roll}},
                                              {Cylinder{.radius_m = 3e-3,
                                              .length_m = 11e-3,
                                              .azimuth_deg = turn.azimuth_deg,
                                              .inclination_deg = turn.inclination_deg}}}) {
        body.shape = shape;
        bodies.push_back(body);
    }
    return bodies;
}

const Domain small_domain{.nx = 64, .ny = 48, .spacing_m = 1e-3};

TEST_CASE("mass and inertia of rigid bodies are those of their shapes", "[lump_markers]") {
    const Medium medium = tissue_medium();
    Body body{.name = "bone", .centre_m = {1.3e-3, -0.7e-3, 9e-3}, .density_kg_m3 = 1900.0};
    double volume_m3 = 0.0, about_x_m2 = 0.0, about_z_m2 = 0.0; // moments of inertia per mass
    SECTION("ellipsoid") {
        const double a = 6e-3, b = 4e-3, c = 2e-3;
        body.shape = Ellipsoid{{a, b, c}};
        volume_m3 = 4.0 / 3.0 * std::numbers::pi * a * b * c;
        about_x_m2 = (b * b + c * c) / 5.0;
        about_z_m2 = (a * a + b * b) / 5.0;
    }
    SECTION("cylinder along x") {
        const double r = 3e-3, length = 11e-3;
        body.shape = Cylinder{.radius_m = r, .length_m = length};
        volume_m3 = std::numbers::pi * r * r * length;
        about_x_m2 = r * r / 2.0;
        about_z_m2 = (3.0 * r * r + length * length) / 12.0;
    }
    SECTION("box") {
        const double a = 6e-3, b = 5e-3, c = 3e-3;
        body.shape = Box{{a, b, c}};
        volume_m3 = a * b * c;
        about_x_m2 = (b * b + c * c) / 12.0;
        about_z_m2 = (a * a + b * b) / 12.0;
    }
    const std::vector<double> mass = spectral::lump_mass(body, small_domain, medium);
    const double expected_kg = 900.0 * volume_m3; // the excess over the tissue
    const auto at = [&](std::size_t row, std::size_t column) { return mass[row * 6 + column]; };
    // Observed: 4e-6 for the mass, 3e-4 (the cylinder) for the inertia; boxes are exact.
    for (std::size_t i = 0; i < 3; ++i)
        CHECK(at(i, i) == Approx(expected_kg).epsilon(1e-5));
    CHECK(at(3, 3) == Approx(expected_kg * about_x_m2).epsilon(5e-4));
    CHECK(at(5, 5) == Approx(expected_kg * about_z_m2).epsilon(5e-4));
    for (std::size_t row = 0; row < 6; ++row)
        for (std::size_t column = 0; column < row; ++column)
            CHECK(std::abs(at(row, column)) < 1e-9 * expected_kg);
}

TEST_CASE("markers of flat and narrow bodies do not coincide", "[lump_markers]") {
    // Ellipses with a short axis and pairs of rings near the rim would have points side by side,
    // whose forces are not determined.
    const Domain domain{.nx = 96, .ny = 72, .spacing_m = 1e-3};
    const Vec3 r = GENERATE(Vec3{20e-3, 15e-3, 2e-3}, Vec3{6e-3, 5e-3, 1.2e-3},
                            Vec3{10e-3, 1.1e-3, 1.1e-3}, Vec3{3e-3, 3e-3, 3e-3});
    const Body body{.name = "bone", .shape = Ellipsoid{r}, .centre_m = {0.0, 0.0, 9e-3}};
    const std::vector<Vec3> markers = spectral::lump_markers(body, domain, domain.spacing_m);
    CAPTURE(r.x, r.y, r.z);
    REQUIRE(markers.size() > 8);
    double nearest_m = 1.0, farthest_m = 0.0; // pairs; a marker and the mirror image of another
    for (std::size_t i = 0; i < markers.size(); ++i) {
        double image_m = 1.0;
        for (std::size_t j = 0; j < markers.size(); ++j) {
            if (i != j) nearest_m = std::min(nearest_m, norm(markers[i] - markers[j]));
            const Vec3 image{-markers[j].x, markers[j].y, markers[j].z};
            image_m = std::min(image_m, norm(markers[i] - image));
        }
        farthest_m = std::max(farthest_m, image_m);
    }
    CHECK(nearest_m > 0.4 * domain.spacing_m);
    CHECK(farthest_m < 1e-15); // rounding of positions of 20 mm
}

TEST_CASE("mass and inertia of a turned body are the turned ones of its shape", "[lump_markers]") {
    const Medium medium = tissue_medium();
    for (const Body& body : turned_bodies()) {
        CAPTURE(body.shape.index());
        const auto mass = spectral::lump_mass(body, small_domain, medium);
        const auto plain = spectral::lump_mass(aligned(body), small_domain, medium);
        const BodyAxes f = axes_of(body);
        const double rotation[3][3] = {
            {f.x.x, f.y.x, f.z.x}, {f.x.y, f.y.y, f.z.y}, {f.x.z, f.y.z, f.z.z}};
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                // R J R^T, where J is the inertia along the axes of the body.
                double turned = 0.0;
                for (std::size_t k = 0; k < 3; ++k)
                    for (std::size_t l = 0; l < 3; ++l)
                        turned += rotation[i][k] * plain[(3 + k) * 6 + 3 + l] * rotation[j][l];
                // Sums of 24^3 terms in another order.
                CHECK(std::abs(mass[(3 + i) * 6 + 3 + j] - turned) < 1e-12 * plain[5 * 6 + 5]);
                CHECK(std::abs(mass[i * 6 + j] - plain[i * 6 + j]) < 1e-12 * plain[0]);
                CHECK(std::abs(mass[i * 6 + 3 + j]) < 1e-12 * plain[0]); // about the centre
            }
    }
}

TEST_CASE("markers of turned bodies lie inside them on a limited number of depths",
          "[lump_markers]") {
    const double h_m = 1e-3;
    for (const Body& body : turned_bodies()) {
        CAPTURE(body.shape.index());
        const auto markers = spectral::lump_markers(body, small_domain, h_m);
        const auto plain = spectral::lump_markers(aligned(body), small_domain, h_m);
        // As many as without orientation, apart from the distances between insets.
        CHECK(static_cast<double>(markers.size()) ==
              Approx(static_cast<double>(plain.size())).epsilon(0.35));
        std::set<double> depths;
        Body wider = body; // the surface is inset, but depths are moved by up to 0.15 spacings
        wider.edge_m = 0.32 * h_m;
        for (const Vec3 offset_m : markers) {
            CHECK(volume_fraction(wider, body.centre_m + offset_m, {}) > 0.0);
            depths.insert(offset_m.z);
        }
        const Bounds box = bounds(body);
        CHECK(static_cast<double>(depths.size()) <=
              (box.high_m.z - box.low_m.z) / (0.3 * h_m) + 1.0);
    }
}

TEST_CASE("a turned body does not cross the domain", "[lump_markers]") {
    Body body{.name = "slab", .shape = Box{{1.0, 1.0, 4e-3}}, .centre_m = {0.0, 0.0, 9e-3}};
    CHECK(spectral::endless_along(body, small_domain) == spectral::Endless::both);
    std::get<Box>(body.shape).orientation.azimuth_deg = 45.0;
    CHECK(spectral::endless_along(body, small_domain) == spectral::Endless::no);
}

} // namespace test_lump_markers
