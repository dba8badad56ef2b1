// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/lump_markers.hpp"

#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>
#include <numbers>

using namespace shearwake;

TEST_CASE("mass and inertia of rigid bodies are those of their shapes", "[lump_markers]") {
    Medium medium;
    medium.layers = {{.name = "tissue",
                      .thickness_m = 0.02,
                      .density_kg_m3 = 1000.0,
                      .c_p_m_s = 1500.0,
                      .c_s_m_s = 5.0}};
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
    const Domain domain{.nx = 64, .ny = 48, .spacing_m = 1e-3};
    const std::vector<double> mass = spectral::lump_mass(body, domain, medium);
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
