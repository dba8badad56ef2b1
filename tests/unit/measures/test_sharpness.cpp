// SPDX-License-Identifier: BSD-3-Clause
#include "measures/spatial_measures.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

namespace test_sharpness {

using namespace shearwake;

static Domain domain() {
    return {.nx = 96, .ny = 80, .spacing_m = 0.5e-3};
}

static std::vector<double> surface(const auto& energy) {
    const Domain d = domain();
    std::vector<double> values;
    for (std::ptrdiff_t i = 0; i < d.nx; ++i)
        for (std::ptrdiff_t j = 0; j < d.ny; ++j)
            values.push_back(energy(d.x_m(i), d.y_m(j)));
    return values;
}

static double sharpness_of(const std::vector<double>& values,
                           const std::vector<std::vector<Vec2>>& lines, double reach_m) {
    const Domain d = domain();
    return measures::sharpness({values.data(), d.nx, d.ny}, d, measures::measured_region(d), lines,
                               reach_m);
}

TEST_CASE("a Gaussian ridge along the drawn line has the sharpness of its error function",
          "[sharpness]") {
    const double reach_m = GENERATE(1.0e-3, 2.13e-3, 4.0e-3);
    const double width_m = 2e-3;
    const auto ridge =
        surface([&](double, double y) { return std::exp(-0.5 * y * y / (width_m * width_m)); });
    const double expected = std::erf(reach_m / (std::numbers::sqrt2 * width_m));
    // A cell at the rim counts by how far its middle is inside: second order in the spacing, here
    // (0.5 mm / 2 mm)^2 / 24.
    CHECK(sharpness_of(ridge, {{{-0.1, 0.0}, {0.1, 0.0}}}, reach_m) ==
          Approx(expected).margin(0.003));
}

TEST_CASE("all of a ring's energy lies near the circle that is drawn along it", "[sharpness]") {
    const double radius_m = 12e-3;
    const auto ring = surface([&](double x, double y) {
        return std::abs(std::hypot(x, y) - radius_m) < 1e-3 ? 1.0 : 0.0;
    });
    std::vector<Vec2> circle;
    for (int n = 0; n <= 400; ++n)
        circle.push_back({radius_m * std::cos(n * std::numbers::pi / 200),
                          radius_m * std::sin(n * std::numbers::pi / 200)});
    // 1.5 mm leaves the ring's rim a whole sample inside; 400 chords cut it by 0.4 um.
    CHECK(sharpness_of(ring, {circle}, 1.5e-3) == Approx(1.0).epsilon(1e-12));
    CHECK(sharpness_of(ring, {{{0.0, 0.0}}}, 9e-3) == 0.0);
}

TEST_CASE("a point is surrounded by a disc of the reach", "[sharpness]") {
    const Domain d = domain();
    const std::vector<std::vector<Vec2>> point = {{{1.1e-3, -0.7e-3}}};
    double area_m2 = 0.0;
    for (const double share : measures::shares_near(point, 6e-3, d))
        area_m2 += share * d.spacing_m * d.spacing_m;
    // The rim is 75 cells long, each off by at most a few hundredths of its area.
    CHECK(area_m2 == Approx(std::numbers::pi * 36e-6).epsilon(0.003));
}

TEST_CASE("energy near two crossing lines is counted once", "[sharpness]") {
    const auto even = surface([](double, double) { return 1.0; });
    const std::vector<Vec2> along = {{-0.1, 0.0}, {0.1, 0.0}}, across = {{0.0, -0.1}, {0.0, 0.1}};
    const double one = sharpness_of(even, {along}, 2e-3),
                 other = sharpness_of(even, {across}, 2e-3);
    CHECK(sharpness_of(even, {along, along}, 2e-3) == one);
    // The part near both is the product of the two.
    CHECK(sharpness_of(even, {along, across}, 2e-3) ==
          Approx(one + other - one * other).epsilon(0.002));
}

TEST_CASE("a surface at rest has no sharpness", "[sharpness]") {
    CHECK(std::isnan(
        sharpness_of(surface([](double, double) { return 0.0; }), {{{0.0, 0.0}}}, 1e-3)));
}

} // namespace test_sharpness
