// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/skin.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>

namespace test_skin_stress {

using namespace shearwake::neural;
using std::numbers::pi;

TEST_CASE("stress below the centre of a pin equals the closed form", "[neural]") {
    const double depth_mm = GENERATE(0.05, 0.3, 1.6, 2.0, 30.0),
                 radius_mm = GENERATE(0.5, 1.0, 4.0);
    const double xi2 = std::pow(depth_mm / radius_mm, 2);
    const double closed =
        (1.0 + 3.0 * xi2) / std::pow(1.0 + xi2, 2) / (2.0 * pi * radius_mm * radius_mm);
    // At shallow depth q nearly cancels: xi = 0.0125 limits the accuracy to 1e-12.
    CHECK(stress_per_load(0.0, depth_mm, radius_mm) == Approx(closed).epsilon(1e-11));
}

TEST_CASE("stress far from a pin equals that of a point load", "[neural]") {
    const double r = GENERATE(0.0, 20.0, 50.0), z = 30.0, radius_mm = 0.1;
    const double point = 3.0 * z * z * z / (2.0 * pi * std::pow(r * r + z * z, 2.5)); // Boussinesq
    // The extent of the pin contributes (a/z)^2 = 1e-5, times at most 10/3.
    CHECK(stress_per_load(r, z, radius_mm) == Approx(point).epsilon(4e-5));
}

TEST_CASE("stress integrated over any horizontal plane equals the load", "[neural]") {
    const double depth_mm = GENERATE(0.3, 2.0);
    // Integral of stress 2 pi r dr with r = sinh(x) by the trapezoidal rule; the part beyond r =
    // 1.3e5 mm is 1e-16.
    double sum = 0.0;
    const double h = 0.001;
    for (double x = h; x < 12.5; x += h) {
        const double r = std::sinh(x);
        sum += stress_per_load(r, depth_mm, 1.0) * 2.0 * pi * r * std::cosh(x) * h;
    }
    CHECK(sum == Approx(1.0).epsilon(1e-6)); // h^2
}

TEST_CASE("arrival time is the distance from the rim at 8 m/s in samples with ties to even",
          "[neural]") {
    CHECK(arrival_samples(0.5, 1.0, 5000.0) == 0);
    CHECK(arrival_samples(9.0, 1.0, 5000.0) == 5); // 8 mm: 1 ms
    CHECK(arrival_samples(2.0, 1.0, 4000.0) == 0); // 0.5
    CHECK(arrival_samples(4.0, 1.0, 4000.0) == 2); // 1.5
    CHECK(arrival_samples(std::numeric_limits<double>::infinity(), 1.0, 5000.0) > 1000000);
}

TEST_CASE("wave gain follows the surface indentation and the inverse square of the depth",
          "[neural]") {
    CHECK(wave_gain(0.3, 2.0, 1.0) == 0.125);
    CHECK(wave_gain(2.0, 2.0, 1.0) == Approx(std::asin(0.5) / pi / 4.0).epsilon(1e-14));
    CHECK(wave_gain(std::numeric_limits<double>::infinity(), 2.0, 1.0) == 0.0);
}

} // namespace test_skin_stress
