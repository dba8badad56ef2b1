// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/load.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_period {

using namespace shearwake;
using Catch::Contains;

namespace {

Load load_of(std::vector<Mover> parts, std::vector<Gain> gains = {}) {
    Load load;
    load.footprint = GaussianFootprint{3e-3};
    load.modulation.trajectory = {std::move(parts)};
    load.modulation.envelope = {std::move(gains)};
    return load;
}

Travel circle(double draws_per_s, AtEnd at_end = AtEnd::repeat) {
    const double length_m = 2.0 * std::numbers::pi * 1e-2;
    return {Arc{{}, 1e-2, 0.0, 2.0 * std::numbers::pi}, ConstantSpeed{length_m * draws_per_s},
            at_end};
}

double period_ms(const Load& load) {
    const LoadPeriod period = least_period(load, 1.0);
    INFO(period.reason);
    REQUIRE(period.reason.empty());
    return 1e3 * period.period_s;
}

} // namespace

TEST_CASE("the period of a load is the least common one of its parts", "[period]") {
    CHECK(std::abs(period_ms(load_of({circle(70.0)})) - 1e3 / 70.0) < 1e-9);
    CHECK(std::abs(period_ms(load_of({circle(70.0)}, {SineGain{.frequency_Hz = 200.0}})) - 100.0) <
          1e-9);
    CHECK(std::abs(period_ms(load_of({circle(100.0)}, {SineGain{.frequency_Hz = 200.0}})) - 10.0) <
          1e-9);
    CHECK(
        std::abs(period_ms(load_of({Hold{}}, {SquareGain{.frequency_Hz = 125.0, .edge_s = 1e-4}})) -
                 8.0) < 1e-9);
    CHECK(std::abs(period_ms(load_of({Swing{{1e-3, 0.0}, 40.0}, circle(25.0)})) - 200.0) < 1e-9);
    // There and back is one pass.
    const Travel line{Curve(Vec2{}, Vec2{5e-3, 0.0}), ConstantSpeed{1.0}, AtEnd::back_and_forth};
    CHECK(std::abs(period_ms(load_of({line})) - 10.0) < 1e-9);
    // A depth of 0 means that nothing is modulated.
    CHECK(std::abs(
              period_ms(load_of({circle(50.0)}, {SineGain{.frequency_Hz = 77.7, .depth = 0.0}})) -
              20.0) < 1e-9);
    Travel slows = circle(100.0);
    slows.motion = OscillatingSpeed{2.0 * std::numbers::pi, 1.0, 150.0};
    CHECK(std::abs(period_ms(load_of({slows})) - 20.0) < 1e-9);
}

TEST_CASE("a load without a period states the reason", "[period]") {
    const auto reason = [](const Load& load) { return least_period(load, 1.0).reason; };
    CHECK_THAT(reason(load_of({circle(std::sqrt(5e3))}, {SineGain{.frequency_Hz = 200.0}})),
               Contains("70.710678 and 200 Hz") && Contains("no common period of up to 1000 ms"));
    CHECK_THAT(reason(load_of({circle(0.5)})), Contains("the frequency 0.5 Hz"));
    CHECK_THAT(reason(load_of({circle(50.0, AtEnd::off)})), Contains("a path that ends"));
    CHECK_THAT(reason(load_of({Hold{}})), Contains("is constant"));
    CHECK_THAT(reason(load_of({circle(50.0)}, {RampGain{.duration_s = 1e-2}})),
               Contains("rises or falls once"));
}

} // namespace test_period
