// SPDX-License-Identifier: BSD-3-Clause
// Instants at which a load is not smooth.
#include "problem/load/load.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_breaks {

using namespace shearwake;

constexpr double cell_s = 50e-6;

static Load moving(Mover mover, Envelope envelope = {}) {
    Load load;
    load.peak_Pa = 1.0;
    load.footprint = GaussianFootprint{4e-3};
    load.modulation.trajectory.parts = {std::move(mover)};
    load.modulation.envelope = std::move(envelope);
    return load;
}

static std::vector<double> times_s(const Load& load, double until_s) {
    std::vector<double> times;
    for (const Break& each : breaks_of(load, 0.0, until_s, cell_s))
        times.push_back(each.time_s);
    return times;
}

TEST_CASE("breaks are found where a load jumps", "[load][breaks]") {
    // Pass after pass of a line of 20 mm at 7 m/s.
    const Load load =
        moving(Travel{Line{{-1e-2, 0.0}, {1e-2, 0.0}}, ConstantSpeed{7.0}, AtEnd::repeat});
    const std::vector<Break> found = breaks_of(load, 0.0, 9e-3, cell_s);
    REQUIRE(found.size() == 4); // the start, and three jumps
    for (std::size_t i = 0; i < found.size(); ++i) {
        // Bisection ends at neighbouring numbers; the rounding of times and arc lengths remains.
        CHECK(std::abs(found[i].time_s - static_cast<double>(i) * 20e-3 / 7.0) < 1e-15);
        CHECK(found[i].jump == 1.0);
    }
}

TEST_CASE("a path that ends is a break, a closed circle is none", "[load][breaks]") {
    CHECK(times_s(moving(Travel{Line{{-1e-2, 0.0}, {1e-2, 0.0}}, ConstantSpeed{5.0}, AtEnd::off}),
                  9e-3)
              .size() == 2);
    const Arc circle{{}, 5e-3, 0.2, 2.0 * std::numbers::pi};
    CHECK(times_s(moving(Travel{circle, ConstantSpeed{20.0}, AtEnd::repeat}), 9e-3).size() == 1);
}

TEST_CASE("breaks of the slope are corners, turning points and knots of a gain", "[load][breaks]") {
    const Polyline square({{0.0, 0.0}, {1e-2, 0.0}, {1e-2, 1e-2}, {0.0, 1e-2}}, Ends::closed);
    const std::vector<Break> corners =
        breaks_of(moving(Travel{square, ConstantSpeed{10.0}, AtEnd::repeat}), 0.0, 4.5e-3, cell_s);
    REQUIRE(corners.size() == 5); // the start and four corners
    // Over a step the velocity turns by a right angle: 10 m/s sqrt(2) 50 us in units of sigma.
    const double sigma_m = 4e-3 / (2.0 * std::sqrt(2.0 * std::numbers::ln2));
    CHECK(corners[1].kink == Approx(10.0 * std::sqrt(2.0) * cell_s / sigma_m).epsilon(1e-3));
    CHECK(corners[1].jump < 1e-4);

    CHECK(times_s(moving(Swing{{5e-3, 0.0}, 200.0, 0.0, SwingWave::triangle}), 9e-3).size() ==
          1 + 4); // turning points at 1.25, 3.75, 6.25 and 8.75 ms
    const Load sampled = moving(Hold{}, {{SampledGain{{0.2, 1.0, 0.6}, 1e-3, false}}});
    CHECK(times_s(sampled, 9e-3).size() == 3); // the last value is held
    // A sin^2 edge bends at its beginning and at its end.
    const Load windowed = moving(Hold{}, {{WindowGain{2e-3, 6e-3, 250e-6}}});
    const std::vector<Break> edges = breaks_of(windowed, 0.0, 9e-3, cell_s);
    REQUIRE(edges.size() == 4);
    CHECK(edges[0].jump < 1e-4);
    const double rate = std::numbers::pi / 250e-6;
    CHECK(edges[0].bend == Approx(0.5 * rate * rate * cell_s * cell_s).epsilon(0.05));
}

TEST_CASE("updates of an array are breaks only while its focus moves", "[load][breaks]") {
    Load load = moving(Travel{Line{{-1e-2, 0.0}, {1e-2, 0.0}}, ConstantSpeed{2.0}, AtEnd::off});
    ArrayFootprint array;
    array.reach_m = 4e-2;
    array.update_rate_Hz = 1000.0;
    load.footprint = array;
    const std::vector<double> times = times_s(load, 5.5e-3);
    REQUIRE(times.size() == 6); // the start and the updates after 1, 2, 3, 4 and 5 ms
    CHECK(times[3] == Approx(3e-3).epsilon(1e-8));
    load.modulation.trajectory.parts = {Hold{}};
    CHECK(times_s(load, 5.5e-3).size() == 1);
}

TEST_CASE("the points of a sampled curve are not breaks", "[load][breaks]") {
    std::vector<Vec2> points;
    for (int i = 0; i < 400; ++i)
        points.push_back({5e-3 * std::cos(i * std::numbers::pi / 200),
                          5e-3 * std::sin(i * std::numbers::pi / 200)});
    const Travel travel{Polyline(points, Ends::closed), ConstantSpeed{7.0}, AtEnd::repeat};
    CHECK(times_s(moving(travel), 9e-3).size() == 1);
}

} // namespace test_breaks
