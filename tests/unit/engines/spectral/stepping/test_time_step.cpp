// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/time_step.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>

namespace test_time_step {

using namespace shearwake;

static Case some_case() {
    Case c = test::moving_focus({}, ConstantSpeed{7.0});
    c.scene.medium = {{test::tissue(1500.0, 0.5)}, Base::rigid};
    c.scene.medium.layers[0].thickness_m = 12e-3;
    c.time = {40, 100e-6};
    return c;
}

static double step_s(const Case& c, double accuracy = 1e-3) {
    return spectral::choose_time_step(c, SpectralOptions{.accuracy = accuracy}).step_s;
}

TEST_CASE("uses the specified time step, shortened to divide the output interval", "[spectral]") {
    const spectral::TimeStep exact =
        spectral::choose_time_step(some_case(), SpectralOptions{.time_step_s = 25e-6});
    CHECK(exact.step_s == 25e-6);
    CHECK(exact.per_frame == 4);
    CHECK(exact.why == "time step 25 us, as specified in the job");
    const spectral::TimeStep shorter =
        spectral::choose_time_step(some_case(), SpectralOptions{.time_step_s = 30e-6});
    CHECK(shorter.step_s == 25e-6);
}

TEST_CASE("the choice of a time step ends when its time has passed", "[spectral]") {
    CHECK_THROWS_AS(
        spectral::choose_time_step(some_case(), SpectralOptions{}, engines::ChoiceLimit(0.0)),
        engines::StepNotChosen);
}

TEST_CASE("the choice of the time step of a long run does not advance all of its frames",
          "[spectral]") {
    Case c = some_case();
    test::travel_of(c).at_end = AtEnd::back_and_forth;
    c.time.interval_s = 250e-6;
    c.time.frames = 2500;
    const double usual_s = step_s(c, 1e-2);
    // Losses end the memory of the field, so that the error does not grow with the duration. Steps
    // divide the interval and differ by up to a half.
    c.time.frames = 10'000;
    CHECK(step_s(c, 1e-2) == Approx(usual_s).epsilon(0.5));
    // 70 hours would take days if all frames were advanced.
    c.time.frames = 1'000'000'000;
    CHECK(step_s(c, 1e-2) <= usual_s * (1.0 + 1e-12));
}

TEST_CASE("error of a long run is extrapolated as it grows", "[spectral]") {
    Case c = some_case();
    test::travel_of(c).at_end = AtEnd::back_and_forth;
    const bool lossy = GENERATE(true, false);
    if (!lossy) c.scene.medium.layers[0].loss = Lossless{};
    const double step_s = lossy ? 250e-6 : 62.5e-6; // the error does not reach its limit
    const spectral::DepthMesh mesh = spectral::choose_mesh(c, SpectralOptions{}, step_s);
    const auto error = [&](std::ptrdiff_t frames, double interval_s) {
        c.time = {frames, interval_s};
        return spectral::probed_error(c, mesh, step_s);
    };
    // The first half of the second run is advanced, all of the third one.
    const double half = error(2500, 250e-6), extrapolated = error(5000, 250e-6),
                 advanced = error(2500, 500e-6);
    CAPTURE(lossy, half, extrapolated, advanced);
    // The choice of the step has a safety factor of two. Observed 1.01 with losses, 0.71 without.
    CHECK(extrapolated > 0.5 * advanced);
    CHECK(extrapolated < 2.0 * advanced);
    CHECK((advanced > 1.3 * half) == !lossy);
}

TEST_CASE("chooses a shorter step for faster or finer motion and for higher accuracy",
          "[spectral][slow]") {
    const Case c = some_case();
    const double usual_s = step_s(c);
    CHECK(step_s(c, 1e-4) < usual_s);
    CHECK(step_s(c, 1e-1) > usual_s);
    CHECK(c.time.interval_s / usual_s == Approx(std::round(c.time.interval_s / usual_s)));
    Case other = c;
    SECTION("a finer focus") {
        other.scene.load.footprint = GaussianFootprint{1.5e-3};
    }
    SECTION("a faster scan") {
        test::travel_of(other).motion = ConstantSpeed{14.0};
    }
    SECTION("stiffer tissue") {
        other.scene.medium.layers[0].c_s_m_s = 12.0;
    }
    SECTION("a fast modulation") {
        other.scene.load.modulation.envelope.gains = {SineGain{.frequency_Hz = 2000.0}};
    }
    SECTION("a resolved carrier") {
        other.scene.load.carrier = ResolvedCarrier{};
        CHECK(step_s(other) < 0.25 / 40e3); // otherwise the carrier is not resolved
    }
    SECTION("a stiff body near the surface") {
        other.scene.medium.bodies = {{.name = "body",
                                      .shape = Ellipsoid{{3e-3, 3e-3, 1e-3}},
                                      .centre_m = {0.0, 0.0, 1.5e-3},
                                      .c_s_m_s = 50.0}};
    }
    SECTION("a stiff map near the surface") {
        MaterialMap map{.counts = {1, 1, 2}, .origin_m = {0.0, 0.0, 1e-3}, .c_s_m_s = {5.0, 50.0}};
        map.spacing_m = {0.0, 0.0, 1e-3};
        other.scene.medium.map = std::make_shared<MaterialMap>(map);
    }
    CHECK(step_s(other) < usual_s);
}

TEST_CASE("reports the reason for the chosen time step", "[spectral]") {
    const auto why = [](const Case& c) {
        return spectral::choose_time_step(c, SpectralOptions{.accuracy = 1e-2}).why;
    };
    Case c = some_case();
    CHECK_THAT(why(c), Catch::Contains("for an accuracy of 0.01 (estimated error ") &&
                           Catch::Contains("limited by the scan (6.8 mm at 7 m/s, 1.03e+03 Hz)"));
    c.scene.load.modulation.envelope.gains = {SineGain{.frequency_Hz = 2000.0}};
    CHECK_THAT(why(c), Catch::Contains("limited by the modulation (2e+03 Hz)"));
    c = some_case();
    c.scene.medium.layers[0].c_s_m_s = 12.0;
    CHECK_THAT(why(c), Catch::Contains("limited by shear waves (6.8 mm at 12 m/s"));
    c = some_case();
    c.scene.load.footprint = GaussianFootprint{30e-3};
    CHECK_THAT(why(c), Catch::Contains("one step per frame is sufficient"));
    c = some_case();
    c.scene.medium.bodies = {{.name = "body",
                              .shape = Ellipsoid{{3e-3, 3e-3, 1e-3}},
                              .centre_m = {0.0, 0.0, 1.5e-3},
                              .c_s_m_s = 50.0}};
    CHECK_THAT(why(c), Catch::Contains("limited by the stiffest inclusion"));
}

} // namespace test_time_step
