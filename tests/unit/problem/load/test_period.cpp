// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/load.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <regex>

namespace test_period {

using namespace shearwake;
using Catch::Contains;

static Load load_of(std::vector<Mover> parts, std::vector<Gain> gains = {}) {
    Load load;
    load.footprint = GaussianFootprint{3e-3};
    load.modulation.trajectory = {std::move(parts)};
    load.modulation.envelope = {std::move(gains)};
    return load;
}

static Travel circle(double draws_per_s, AtEnd at_end = AtEnd::repeat) {
    const double length_m = 2.0 * std::numbers::pi * 1e-2;
    return {Arc{{}, 1e-2, 0.0, 2.0 * std::numbers::pi}, ConstantSpeed{length_m * draws_per_s},
            at_end};
}

static double period_ms(const Load& load) {
    const LoadPeriod period = least_period(load, 1.0);
    INFO(period.reason);
    REQUIRE(period.reason.empty());
    return 1e3 * period.period_s;
}

TEST_CASE("the period of a load is the least common one of its parts", "[period]") {
    // There and back is one pass.
    const Travel line{Curve(Vec2{}, Vec2{5e-3, 0.0}), ConstantSpeed{1.0}, AtEnd::back_and_forth};
    Travel slows = circle(100.0);
    slows.motion = OscillatingSpeed{2.0 * std::numbers::pi, 1.0, 150.0};
    const SineGain sine{.frequency_Hz = 200.0}, depth_0{.frequency_Hz = 77.7, .depth = 0.0};
    const std::vector<std::pair<Load, double>> loads = {
        {load_of({circle(70.0)}), 1e3 / 70.0},
        {load_of({circle(70.0)}, {sine}), 100.0},
        {load_of({circle(100.0)}, {sine}), 10.0},
        {load_of({Hold{}}, {SquareGain{.frequency_Hz = 125.0, .edge_s = 1e-4}}), 8.0},
        {load_of({Swing{{1e-3, 0.0}, 40.0}, circle(25.0)}), 200.0},
        {load_of({line}), 10.0},
        {load_of({circle(50.0)}, {depth_0}), 20.0}, // nothing is modulated
        {load_of({slows}), 20.0},
    };
    for (const auto& [load, expected_ms] : loads)
        CHECK(std::abs(period_ms(load) - expected_ms) < 1e-9);
}

TEST_CASE("a load without a period states the reason", "[period]") {
    const std::vector<std::pair<Load, std::string>> loads = {
        {load_of({circle(std::sqrt(5e3))}, {SineGain{.frequency_Hz = 200.0}}),
         "70.710678 and 200 Hz"},
        {load_of({circle(std::sqrt(5e3))}, {SineGain{.frequency_Hz = 200.0}}),
         "no common period of up to 1000 ms"},
        {load_of({circle(0.5)}), "the frequency 0.5 Hz"},
        {load_of({circle(50.0, AtEnd::off)}), "a path that ends"},
        {load_of({Hold{}}), "is constant"},
        {load_of({circle(50.0)}, {RampGain{.duration_s = 1e-2}}), "rises or falls once"},
    };
    for (const auto& [load, said] : loads)
        CHECK_THAT(least_period(load, 1.0).reason, Contains(said));
}

TEST_CASE("a load without a period names values that have one", "[period]") {
    const double circles_Hz = std::sqrt(5e3);
    const std::string reason =
        least_period(load_of({circle(circles_Hz)}, {SineGain{.frequency_Hz = 200.0}}), 1.0).reason;
    INFO(reason);
    std::smatch found;
    REQUIRE(std::regex_search(reason, found,
                              std::regex("example ([0-9.]+) m/s instead of [0-9.]+ \\(period "
                                         "([0-9.]+) ms\\) or ([0-9.]+) Hz instead of 200 "
                                         "\\(period ([0-9.]+) ms\\)")));
    const double speed_m_s = std::stod(found[1]), gain_Hz = std::stod(found[3]),
                 length_m = 2.0 * std::numbers::pi * 1e-2;
    CHECK(std::abs(speed_m_s / length_m / circles_Hz - 1.0) < 0.01);
    CHECK(std::abs(gain_Hz / 200.0 - 1.0) < 0.01);
    // The message has four digits of a period.
    CHECK(std::abs(period_ms(
                       load_of({circle(speed_m_s / length_m)}, {SineGain{.frequency_Hz = 200.0}})) /
                       std::stod(found[2]) -
                   1.0) < 1e-3);
    CHECK(std::abs(period_ms(load_of({circle(circles_Hz)}, {SineGain{.frequency_Hz = gain_Hz}})) /
                       std::stod(found[4]) -
                   1.0) < 1e-3);
}

} // namespace test_period
