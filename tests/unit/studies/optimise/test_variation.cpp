// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/search/search.hpp"

#include "problem/load/load.hpp"
#include "unit/config/jobs.hpp"

#include <cmath>
#include <numbers>
#include <set>

namespace test_variation {

using namespace shearwake;
using namespace shearwake::optimise;
using namespace shearwake::test;

namespace {

/// A circle in the steady state.
Case circle(const std::string& measure = "") {
    return only_case(R"(
schema = 1
[job]
name = "circle"
[medium]
preset = "thesis-tissue"
[load]
peak_Pa = 100.0
footprint = { shape = "gaussian", fwhm_mm = 6.0 }
[load.modulation]
kind = "STM"
path = { shape = "circle", radius_mm = 8.0 }
draw_frequency_Hz = 140.0
[domain]
extent_mm = [48.0, 48.0]
spacing_mm = 2.0
edges = "open"
[time]
regime = "periodic"
output_interval_us = 250.0
[solver]
engine = "layered"
)" + measure);
}

} // namespace

TEST_CASE("a uniformity is required of a focus that moves along a path", "[optimise]") {
    Case c = circle();
    CHECK(why_not(c, {.uniformity = 0.8}).empty());
    c.scene.load.modulation.trajectory.parts = {Hold{}};
    CHECK(why_not(c, {.uniformity = 0.8}) ==
          "optimise.uniformity requires a focus that moves along a path");
}

TEST_CASE("a larger or slower path takes longer, and its load repeats with it", "[optimise]") {
    const Case c = circle();
    REQUIRE(has_speed(c));
    const auto larger = with_motion(c, {.size = 1.25});
    REQUIRE(larger);
    CHECK(larger->time.frames == c.time.frames);
    CHECK(larger->time.duration_s() == Approx(1.25 / 140.0).epsilon(1e-12));
    CHECK(least_period(larger->scene.load, 1.0).period_s == Approx(1.25 / 140.0).epsilon(1e-12));
    const auto slower = with_motion(c, {.speed = 0.8, .periods = 2, .sine = 0.1, .cosine = 0.1});
    REQUIRE(slower);
    CHECK(slower->time.duration_s() == Approx(1.25 / 140.0).epsilon(1e-12));
    const auto& travel = std::get<Travel>(slower->scene.load.modulation.trajectory.parts.front());
    const auto& motion = std::get<OscillatingSpeed>(travel.motion);
    CHECK(motion.frequency_Hz == Approx(2.0 * 140.0 / 1.25).epsilon(1e-12));
    CHECK(motion.mean_m_s == Approx(0.8 * speed_m_s(c)).epsilon(1e-12));
    // sin(a + 45 degrees) = (sin a + cos a) / 2^1/2.
    CHECK(motion.deviation_m_s == Approx(std::sqrt(0.02) * motion.mean_m_s).epsilon(1e-12));
    CHECK(motion.phase_rad == Approx(0.25 * std::numbers::pi).epsilon(1e-12));
    CHECK_FALSE(with_motion(c, {.size = 10.0})); // leaves the domain
}

TEST_CASE("a round of the search changes each varied quantity in both directions", "[optimise]") {
    OptimiseOptions options;
    options.over = {OptimisedPart::envelope, OptimisedPart::speed, OptimisedPart::size};
    options.factor_at_most = 1.44;
    const auto changes = changes_around({}, 0.5, options);
    REQUIRE(changes.size() == 4);
    CHECK(changes[0].speed == Approx(1.2).epsilon(1e-12));
    CHECK(changes[1].speed == Approx(1.0 / 1.2).epsilon(1e-12));
    CHECK(changes[2].size == Approx(1.2).epsilon(1e-12));
    // At the limit, a quantity can change in one direction only.
    CHECK(changes_around({.size = 1.44}, 0.5, options).size() == 3);
    options.over = {OptimisedPart::envelope, OptimisedPart::speed_profile};
    CHECK(changes_around({}, 0.5, options).size() == 12); // three frequencies
    CHECK(changes_around({.periods = 2, .sine = 0.1}, 0.5, options).size() == 4);
}

TEST_CASE("an optimum is computed in eight other tissues and at two other speeds", "[optimise]") {
    const auto differences = differences_by(0.2);
    REQUIRE(differences.size() == 10);
    std::set<std::string> ids;
    const Case c = circle();
    for (const Difference& difference : differences) {
        const auto other = with_difference(c, difference);
        REQUIRE(other);
        CHECK(other->scene.medium.layers[0].c_s_m_s == Approx(5.0 * difference.c_s));
        CHECK(other->scene.medium.layers[0].loss ==
              ShearLoss(KelvinVoigt{1.0 * difference.viscosity}));
        CHECK(speed_m_s(*other) == Approx(difference.speed * speed_m_s(c)));
        ids.insert(case_id(*other));
    }
    CHECK(ids.size() == 10);
    CHECK_FALSE(ids.contains(case_id(c)));
}

TEST_CASE("quotients are found by the names of their columns", "[optimise]") {
    const Case c = circle("[measure]\nbands_Hz = [[40, 400]]\n");
    CHECK(quotients_of(c) == std::vector<std::string>{"eta_period_1", "sharpness_1",
                                                      "share_40_400_1", "velocity_share_40_400_1"});
    CHECK(find_quotient(c, "share_40_400_1")->band == FrequencyBand{40.0, 400.0});
    CHECK_FALSE(find_quotient(c, "share_40_500_1"));
    CHECK_FALSE(find_quotient(c, "peak_um"));
}

} // namespace test_variation
