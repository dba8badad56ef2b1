#include "neural/skin_stress.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

using namespace shearwake::neural;
using std::numbers::pi;

TEST_CASE("below a pin's middle the stress has its closed form", "[neural]") {
    const double depth_mm = GENERATE(0.05, 0.3, 1.6, 2.0, 30.0),
                 radius_mm = GENERATE(0.5, 1.0, 4.0);
    const double xi2 = std::pow(depth_mm / radius_mm, 2);
    const double closed =
        (1.0 + 3.0 * xi2) / std::pow(1.0 + xi2, 2) / (2.0 * pi * radius_mm * radius_mm);
    // Shallow, q nearly cancels: xi = 0.0125 leaves 1e-12.
    CHECK(stress_per_load(0.0, depth_mm, radius_mm) == Approx(closed).epsilon(1e-11));
}

TEST_CASE("far from a pin the stress is that of a point load", "[neural]") {
    const double r = GENERATE(0.0, 20.0, 50.0), z = 30.0, radius_mm = 0.1;
    const double point = 3.0 * z * z * z / (2.0 * pi * std::pow(r * r + z * z, 2.5)); // Boussinesq
    // The pin's extent counts by (a/z)^2 = 1e-5, times at most 10/3.
    CHECK(stress_per_load(r, z, radius_mm) == Approx(point).epsilon(4e-5));
}

TEST_CASE("the stress on every plane carries the whole load", "[neural]") {
    const double depth_mm = GENERATE(0.3, 2.0);
    // int stress 2 pi r dr in r = sinh(x), by the trapezoidal rule; beyond r = 1.3e5 mm, 1e-16.
    double sum = 0.0;
    const double h = 0.001;
    for (double x = h; x < 12.5; x += h) {
        const double r = std::sinh(x);
        sum += stress_per_load(r, depth_mm, 1.0) * 2.0 * pi * r * std::cosh(x) * h;
    }
    CHECK(sum == Approx(1.0).epsilon(1e-6)); // h^2
}

TEST_CASE("the wave needs whole samples at 8 m/s from the pin's rim, halves to even", "[neural]") {
    CHECK(arrival_samples(0.5, 1.0, 5000.0) == 0);
    CHECK(arrival_samples(9.0, 1.0, 5000.0) == 5); // 8 mm: 1 ms
    CHECK(arrival_samples(2.0, 1.0, 4000.0) == 0); // 0.5
    CHECK(arrival_samples(4.0, 1.0, 4000.0) == 2); // 1.5
    CHECK(arrival_samples(std::numeric_limits<double>::infinity(), 1.0, 5000.0) > 1000000);
}

TEST_CASE("a wave weakens as the surface sinks, and with the square of the depth", "[neural]") {
    CHECK(wave_gain(0.3, 2.0, 1.0) == 0.125);
    CHECK(wave_gain(2.0, 2.0, 1.0) == Approx(std::asin(0.5) / pi / 4.0).epsilon(1e-14));
    CHECK(wave_gain(std::numeric_limits<double>::infinity(), 2.0, 1.0) == 0.0);
}

TEST_CASE("a line is added later and weaker, and nothing before it comes", "[neural]") {
    const std::vector<double> line = {1.0, 2.0, 3.0};
    std::vector<double> sum = {10.0, 10.0, 10.0};
    add_delayed(line, 1, 0.5, sum);
    CHECK(sum == std::vector{10.0, 10.5, 11.0});
    add_delayed(line, 3, 0.5, sum);
    CHECK(sum == std::vector{10.0, 10.5, 11.0});
}
