// SPDX-License-Identifier: BSD-3-Clause
// Engine "spectral" with bodies of every kind of material: stability, and accuracy at the usual
// step.
#include "support/spectral_cases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

namespace test_spectral_materials {

using namespace shearwake;

struct Kind {
    std::string name;
    Body body;
    double limit; // required limit of the error at 25 us
};

static Body with(std::optional<double> Body::*property, double value) {
    Body body = test::small_body();
    body.*property = value;
    return body;
}

static const std::vector<Kind>& kinds() {
    static const std::vector<Kind> all = {
        {"four times softer", test::small_body(0.25), 0.01},
        {"16 times stiffer", test::small_body(16.0), 0.01},
        {"half as dense", with(&Body::density_kg_m3, 500.0), 0.01},
        {"twice as dense", with(&Body::density_kg_m3, 2000.0), 0.01},
        {"lossless", with(&Body::viscosity_Pa_s, 0.0), 0.01},
        {"four times as viscous", with(&Body::viscosity_Pa_s, 2.0), 0.01},
        {"slower in compression", with(&Body::c_p_m_s, 500.0), 0.01},
        {"faster in compression", with(&Body::c_p_m_s, 3500.0), 0.01},
        {"100 times stiffer", test::small_body(100.0), 0.02}, // many iterations
        {"1000 times stiffer", test::small_body(1000.0), 0.02},
    };
    return all;
}

/// 10^5 times stiffer than the tissue: rigid by default, otherwise capped by the engine.
static Kind bone() {
    Body body = test::small_body();
    body.density_kg_m3 = 1900.0;
    body.c_p_m_s = 3517.0;
    body.c_s_m_s = 1619.0;
    return {"bone", body, 0.0};
}

/// As narrow as the body and the path allow.
static Case tissue(double viscosity_Pa_s) {
    Case c = test::small_tissue(viscosity_Pa_s);
    c.domain.nx = 20;
    c.domain.ny = 16;
    test::travel_of(c).path = {{-9.5e-3, 0.0}, {9.5e-3, 0.0}};
    return c;
}

static Case with_body(Case c, const Kind& kind) {
    c.solver = SpectralOptions{};
    c.scene.medium.bodies = {kind.body};
    return c;
}

/// With a residual of a hundredth of the limits, so that only the time error remains. The scheme is
/// of second order or better in the step, so that it is at most a ninth of the error at 25 us.
static Case reference(Case c) {
    std::get<SpectralOptions>(c.solver).residual = 1e-4;
    return test::with_step(c, 25e-6 / 3.0);
}

static void check_stable(const Kind& kind, double step_s, double rigid_above = 1000.0) {
    // Without losses nothing hides a growing mode. After 3 ms the load has ended, so that the
    // energy does not increase; the motion spreads over domain and depth.
    Case c = with_body(test::small_tissue(0.0), kind);
    std::get<SpectralOptions>(c.solver).rigid_above = rigid_above;
    c.time.frames = 140;
    const auto frames = test::frames_of(test::with_step(c, step_s));
    double while_pressed = 0.0, at_the_end = 0.0;
    for (std::ptrdiff_t n = 0; n < 30; ++n)
        while_pressed = test::worse(while_pressed, test::largest(frames.at(n)));
    for (std::ptrdiff_t n = 110; n < 140; ++n)
        at_the_end = test::worse(at_the_end, test::largest(frames.at(n)));
    CAPTURE(kind.name, step_s, while_pressed, at_the_end);
    CHECK(while_pressed < 60e-9); // the focus alone causes 34 nm
    // Observed at most 0.6; an instability would grow by orders of magnitude.
    CHECK(at_the_end < 0.8 * while_pressed);
}

static bool changes_shear(const Kind& kind) {
    return !kind.body.c_p_m_s.has_value();
}

TEST_CASE("error with bodies of any material is within its limit at 25 us", "[verify][extended]") {
    const Kind kind = kinds()[GENERATE(range(std::size_t{0}, std::size_t{10}))];
    const Case c = with_body(tissue(0.5), kind);
    const auto fine = test::last_frame(reference(c));
    const double error =
        9.0 / 8.0 * test::relative_l2(test::last_frame(test::with_step(c, 25e-6)), fine);
    static const auto without =
        test::last_frame(test::with_step(tissue(0.5), 25e-6)); // of all kinds
    const double seen = test::relative_l2(without, fine);
    CAPTURE(kind.name, error, seen);
    CHECK(error < kind.limit);
    // The body affects the field by more than the error. c_p hardly affects shear and has a
    // separate test.
    if (changes_shear(kind)) CHECK(seen > 10.0 * error);
}

TEST_CASE("field with bodies of any material is stable for 14 ms", "[verify][extended]") {
    check_stable(GENERATE(from_range(test::parameters(8, kinds()))), 50e-6);
}

TEST_CASE("field with extreme bodies is stable for 14 ms with half the step",
          "[verify][extended]") {
    const std::string name = GENERATE("100 times stiffer", "half as dense");
    const auto kind = std::ranges::find(kinds(), name, &Kind::name);
    REQUIRE(kind != kinds().end());
    check_stable(*kind, 25e-6);
}

TEST_CASE("field with rigid and with capped bone is stable for 14 ms", "[long][verify]") {
    check_stable(bone(), 50e-6, GENERATE(1000.0, 1e9));
}

TEST_CASE("mean surface displacement reflects the compressibility of a body", "[verify]") {
    // Shear preserves the volume, so that compression alone determines the mean. It is static if
    // the load is switched on gradually, and a millionth of the peak, which requires a small
    // residual.
    Case c = test::small_tissue();
    c.scene.load.modulation.envelope = {{RampGain{1e-3}}};
    c.time.frames = 20;
    const double c_p_m_s = GENERATE(500.0, 3500.0);
    c.scene.medium.bodies = {with(&Body::c_p_m_s, c_p_m_s)};
    c.solver = SpectralOptions{.residual = 1e-6};
    const double pressure_Pa = 2.0 * std::acos(-1.0) * std::pow(3e-3, 2) / (8.0 * std::log(2.0)) /
                               (c.domain.extent_x_m() * c.domain.extent_y_m());
    const auto compression_m = [&](double thickness_m, double speed_m_s) {
        return pressure_Pa * thickness_m / (1000.0 * speed_m_s * speed_m_s);
    };
    const auto mean_at = [&](double step_s) {
        return test::mean(test::last_frame(test::with_step(c, step_s)));
    };
    const double usual = mean_at(25e-6), fine = mean_at(12.5e-6);
    CAPTURE(c_p_m_s, usual, fine);
    CHECK(usual == Approx(fine).epsilon(0.01)); // required; observed 5e-4
    const double without = compression_m(7e-3, 1500.0);
    CHECK(std::abs(fine / without - 1.0) > 0.05);
    // A body that fills 3 mm of the plane corresponds to layers in series.
    c.scene.medium.bodies[0].shape = Box{{1.0, 1.0, 3e-3}};
    c.scene.medium.bodies[0].centre_m = {0.0, 0.0, 3.5e-3};
    test::divide_layer(c, {2e-3, 3e-3, 2e-3});
    const double row = compression_m(4e-3, 1500.0) + compression_m(3e-3, c_p_m_s);
    // Inertia during the ramp; otherwise static.
    CHECK(mean_at(25e-6) == Approx(row).epsilon(0.005));
}

} // namespace test_spectral_materials
