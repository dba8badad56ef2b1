// SPDX-License-Identifier: BSD-3-Clause
#include "measures/spatial_measures.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace test_disc_fraction {

using namespace shearwake;

constexpr double pi = std::numbers::pi;

/// Share of n x n points of the unit cell about (x, y) that lie in the disc.
static double by_counting(double x, double y, Vec2 centre, double radius, int n) {
    int inside = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            inside += std::hypot(x + (i + 0.5) / n - 0.5 - centre.x,
                                 y + (j + 0.5) / n - 0.5 - centre.y) < radius;
    return inside / static_cast<double>(n * n);
}

TEST_CASE("disc fractions agree with counting points in the cell", "[disc_fraction]") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> place(-2.0, 2.0), size(0.1, 2.5);
    for (int trial = 0; trial < 60; ++trial) {
        const Vec2 centre{place(random), place(random)};
        const double radius = size(random);
        // 400 x 400 points: the cut of a circle through a row is off by half a point at most.
        CHECK(measures::disc_fraction(0.3, -0.2, 1.0, centre, radius) ==
              Approx(by_counting(0.3, -0.2, centre, radius, 400)).margin(2e-3));
    }
}

TEST_CASE("disc fractions add up to the area of the disc anywhere", "[disc_fraction]") {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> place(-1.0, 1.0);
    const double radius = GENERATE(1e-3, 0.2, 0.5, 1.0, 4.0, 13.3);
    for (int trial = 0; trial < 20; ++trial) {
        // Also exactly on a sample, on an edge between cells and on a corner of cells.
        Vec2 centre{place(random), place(random)};
        if (trial == 0) centre = {0.0, 0.0};
        if (trial == 1) centre = {0.5, 0.0};
        if (trial == 2) centre = {0.5, 0.5};
        double sum = 0.0;
        for (int i = -16; i <= 16; ++i)
            for (int j = -16; j <= 16; ++j)
                sum += measures::disc_fraction(i, j, 1.0, centre, radius);
        CHECK(sum == Approx(pi * radius * radius).epsilon(1e-12)); // rounding of exact areas
    }
}

TEST_CASE("disc fractions of known shapes", "[disc_fraction]") {
    struct Disc {
        Vec2 centre;
        double radius, fraction, epsilon;
    };
    const auto [centre, radius, fraction, epsilon] = GENERATE(
        Disc{{0.0, 0.0}, 0.5, pi / 4, 1e-14}, Disc{{0.5, 0.0}, 0.1, pi * 0.005, 1e-13},
        Disc{{0.5, 0.5}, 1.0, pi / 4, 1e-14}, Disc{{-0.5, 0.5}, 1e-6, pi * 0.25e-12, 1e-10},
        Disc{{0.2, -0.3}, 1e-9, pi * 1e-18, 1e-12}, Disc{{0.0, 0.0}, 10.0, 1.0, 0.0},
        Disc{{0.0, 0.0}, std::sqrt(0.5), 1.0, 1e-14}, Disc{{0.0, 0.0}, 0.0, 0.0, 0.0},
        Disc{{-3.0, 0.0}, 2.5, 0.0, 0.0}); // touches the cell's edge
    const double found = measures::disc_fraction(0.0, 0.0, 1.0, centre, radius);
    CHECK(std::abs(found - fraction) <= epsilon * fraction);
}

TEST_CASE("disc fractions do not depend on the unit of length", "[disc_fraction]") {
    CHECK(measures::disc_fraction(0.75e-3, 1.5e-3, 0.75e-3, {0.1e-3, 0.2e-3}, 1.6e-3) ==
          Approx(measures::disc_fraction(0.75, 1.5, 0.75, {0.1, 0.2}, 1.6)).epsilon(1e-13));
}

} // namespace test_disc_fraction
