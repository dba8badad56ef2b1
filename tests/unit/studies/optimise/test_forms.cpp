// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/forms.hpp"

#include "base/error.hpp"
#include "problem/load/load.hpp"
#include "unit/config/jobs.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_forms {

using namespace shearwake;
using namespace shearwake::optimise;
using namespace shearwake::test;

/// A circle in the steady state.
static Case circle(const std::string& measure = "") {
    std::string job =
        with_modulation("kind = \"STM\"\npath = { shape = \"circle\", radius_mm = 8.0 }\n"
                        "draw_frequency_Hz = 140.0");
    for (const auto& [old, by] : {std::pair{"fwhm_mm = 3.0", "fwhm_mm = 6.0"},
                                  {"[96.0, 64.0]", "[48.0, 48.0]\nedges = \"open\""},
                                  {"spacing_mm = 0.75", "spacing_mm = 2.0"},
                                  {"duration_ms = 4.0", "regime = \"periodic\""},
                                  {"interval_us = 50.0", "interval_us = 250.0"}})
        job = replaced(job, old, by);
    return only_case(job + measure);
}

TEST_CASE("a uniformity is required of a focus that moves along a path", "[optimise]") {
    Case c = circle();
    const OptimiseOptions options{.uniformity = 0.8};
    const Knots knots = knots_of(c, options.knot_s);
    CHECK_NOTHROW(require_optimisable(c, "id", knots, options));
    c.scene.load.modulation.trajectory.parts = {Hold{}};
    CHECK_THROWS_WITH(
        require_optimisable(c, "id", knots, options),
        Catch::Matchers::Contains("optimise.uniformity requires a focus that moves along a path"));
}

TEST_CASE("a display repeats a whole number of updates", "[optimise]") {
    const Case c = circle();
    const Knots knots{.count = 4, .interval_s = 1e-3, .repeat = true};
    const Knots pass{.count = 4, .interval_s = 1e-3, .repeat = false};
    CHECK_NOTHROW(require_optimisable(c, "id", knots, {.update_rate_Hz = 2000.0}));
    // 8.4 updates in 4 ms; a single pass ends at 3 ms, after 6.3 updates.
    CHECK_THROWS_AS(require_optimisable(c, "id", knots, {.update_rate_Hz = 2100.0}), UsageError);
    CHECK_NOTHROW(require_optimisable(c, "id", pass, {.update_rate_Hz = 2100.0}));
    // 4000 updates
    CHECK_THROWS_AS(require_optimisable(c, "id", knots, {.update_rate_Hz = 1e6}), UsageError);
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

TEST_CASE("another tissue changes c_s and the viscosity, another speed the motion", "[optimise]") {
    const Case c = circle();
    const auto other = with_difference(c, {.c_s = 1.2, .viscosity = 0.8});
    REQUIRE(other);
    CHECK(other->scene.medium.layers[0].c_s_m_s == Approx(6.0));
    CHECK(other->scene.medium.layers[0].loss == ShearLoss(KelvinVoigt{0.8}));
    CHECK(speed_m_s(*other) == speed_m_s(c));
    const auto slower = with_difference(c, {.speed = 0.8});
    REQUIRE(slower);
    CHECK(speed_m_s(*slower) == Approx(0.8 * speed_m_s(c)));
    CHECK(slower->scene.medium == c.scene.medium);
}

TEST_CASE("quotients are found by the names of their columns", "[optimise]") {
    const Case c = circle("[measure]\nbands_Hz = [[40, 400]]\n");
    CHECK(quotients_of(c) == std::vector<std::string>{"eta_period_1", "sharpness_1",
                                                      "share_40_400_1", "velocity_share_40_400_1"});
    CHECK(find_quotient(c, "share_40_400_1")->band == FrequencyBand{40.0, 400.0});
    CHECK_FALSE(find_quotient(c, "share_40_500_1"));
    CHECK_FALSE(find_quotient(c, "peak_um"));
}

} // namespace test_forms
