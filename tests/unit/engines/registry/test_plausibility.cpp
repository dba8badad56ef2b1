// SPDX-License-Identifier: BSD-3-Clause
#include "engines/registry/check.hpp"
#include "support/cases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>

namespace test_plausibility {

using namespace shearwake;

/// A focus at rest on 96 x 96 mm for 14 ms, with a body and a scan.
static Case good_case() {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0, 1.0)), ConstantSpeed{7.0});
    c.scene.load.modulation.trajectory.parts = {Hold{}};
    c.scene.load.peak_Pa = 100.0;
    c.scene.medium.bodies = {
        {.name = "body", .shape = Box{.size_m = {8e-3, 8e-3, 4e-3}}, .centre_m = {0.0, 0.0, 4e-3}}};
    c.domain = {.nx = 128, .ny = 128, .spacing_m = 0.75e-3};
    c.time = {.frames = 140, .interval_s = 1e-4};
    c.measure = {.at_s = 14e-3, .focal_radius_m = 3e-3};
    c.measure.region_m = {{-0.02, -0.02}, {0.02, -0.02}, {0.02, 0.02}, {-0.02, 0.02}};
    c.vibrometer.emplace();
    c.vibrometer->points_m = {{0.0, 0.0}, {10e-3, 0.0}};
    c.vibrometer->noise_m_s_rtHz = 1e-6;
    return c;
}

static bool is_remarked(const Case& c, const char* key, std::string_view part) {
    const auto remarks = check_plausibility(c);
    for (const Remark& remark : remarks)
        UNSCOPED_INFO(remark.key << ": " << remark.message);
    return std::ranges::any_of(remarks, [&](const Remark& remark) {
        return remark.severity == Severity::warning && std::string_view(remark.key) == key &&
               remark.message.find(part) != std::string::npos;
    });
}

TEST_CASE("values of bodies, regions, scans and envelopes in other units give a warning",
          "[check]") {
    struct Mistake {
        std::function<void(Case&)> make;
        const char *key, *part;
    };
    CHECK(check_plausibility(good_case()).empty());
    const auto body = [](Case& c) -> Body& { return c.scene.medium.bodies[0]; };
    const auto gains = [](Case& c) -> std::vector<Gain>& {
        return c.scene.load.modulation.envelope.gains;
    };
    const Mistake mistakes[] = {
        {[&](Case& c) { body(c).density_kg_m3 = 1.9; }, "medium.body", "a density of 1.9 kg/m^3"},
        {[&](Case& c) { body(c).viscosity_Pa_s = 5000.0; }, "medium.body",
         "viscosity of body 1, 5e+03 Pa s"},
        {[&](Case& c) { body(c).centre_m.z = 4e-6; }, "medium.body",
         "50 % of the height of body 1 lie above the skin"},
        {[&](Case& c) { body(c).centre_m.x = 1e-5; }, "medium.body", "coordinates are in mm"},
        {[](Case& c) {
             c.measure.depths_m = {0.0, 1e-6};
         },
         "measure.depths_mm", "in mm"},
        {[](Case& c) {
             for (Vec2& corner : c.measure.region_m)
                 corner = 0.1 * corner;
         },
         "measure.region_mm", "the region is 4 mm wide, but the focal disc 6 mm"},
        {[](Case& c) {
             for (Vec2& corner : c.measure.region_m)
                 corner.x += 0.03;
         },
         "measure.region_mm", "at 14 ms the focus is at [0, 0] mm, outside of the region"},
        {[](Case& c) { c.vibrometer->trigger_delay_s = 5.0; }, "vibrometer.trigger_delay_ms",
         "the scan has no samples"},
        {[](Case& c) { c.vibrometer->rate_Hz = 51.2; }, "vibrometer.sampling_rate_kHz",
         "0.72 samples in 14 ms"},
        {[](Case& c) { c.vibrometer->noise_m_s_rtHz = 0.5; }, "vibrometer.noise_um_s_rtHz",
         "an rms of 35 m/s"}, // .5 sqrt(5000)
        {[](Case& c) {
             c.vibrometer->points_m[1] = {2e-5, 0.0};
         },
         "vibrometer", "lie within 0.02 mm"},
        {[&](Case& c) { gains(c) = {RampGain{.duration_s = 2e-3, .start_s = 20e-3}}; },
         "load.modulation", "only 0 % of its strength"},
        {[&](Case& c) { gains(c) = {RampGain{.duration_s = 2.0}}; }, "load.modulation",
         "only 0.012 % of its strength"}, // sin^2(pi/2 14/2000)
        {[&](Case& c) { gains(c) = {WindowGain{.from_s = 0.1, .to_s = 0.2}}; }, "load.modulation",
         "only 0 % of its strength"},
    };
    for (const Mistake& mistake : mistakes) {
        Case c = good_case();
        mistake.make(c);
        INFO(mistake.part);
        CHECK(is_remarked(c, mistake.key, mistake.part));
    }
}

TEST_CASE("bodies at the surface, foci at the edge of a region and metals are plausible",
          "[check]") {
    Case c = good_case();
    Body& body = c.scene.medium.bodies[0];
    SECTION("half of an ellipsoid") {
        body.shape = Ellipsoid{{5e-3, 4e-3, 2e-3}};
        body.centre_m.z = 0.0;
    }
    SECTION("a focus at an edge") {
        for (Vec2& corner : c.measure.region_m)
            corner.x += GENERATE(-0.02, 0.02, 0.022);
    }
    SECTION("a path that has ended") {
        Travel travel{{{0.0, 0.0}, {0.05, 0.0}}, ConstantSpeed{7.0}};
        travel.at_end = AtEnd::off;
        c.scene.load.modulation.trajectory.parts = {travel};
    }
    SECTION("tungsten") {
        body.density_kg_m3 = 19300.0;
    }
    SECTION("noise of averaged recordings") {
        c.vibrometer->noise_m_s_rtHz = 1e-3;
        c.vibrometer->averages = 100;
    }
    for (const Remark& remark : check_plausibility(c))
        UNSCOPED_INFO(remark.key << ": " << remark.message);
    CHECK(check_plausibility(c).empty());
}

} // namespace test_plausibility
