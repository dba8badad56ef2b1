// SPDX-License-Identifier: BSD-3-Clause
#include "measures/spatial_measures.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

namespace test_intensity {

using namespace shearwake;

static Load steady_load() {
    return {.peak_Pa = 100.0,
            .footprint = GaussianFootprint{.fwhm_m = 3e-3},
            .modulation = {.trajectory = {{Hold{}}}}};
}

static Travel line(double speed_m_s, AtEnd at_end) {
    return {.path = {{-49e-3, 0.0}, {49e-3, 0.0}},
            .motion = ConstantSpeed{speed_m_s},
            .at_end = at_end};
}

TEST_CASE("a steady load delivers force times time", "[intensity]") {
    const double force = 100.0 * std::numbers::pi * 9e-6 / (4.0 * std::numbers::ln2);
    CHECK(measures::impulse_N_s(steady_load(), 14e-3) ==
          Approx(force * 14e-3).epsilon(1e-12)); // rounding
    CHECK(measures::impulse_N_s(steady_load(), 0.0) == 0.0);
}

TEST_CASE("the impulse ends when the path does, exactly", "[intensity]") {
    Load load = steady_load();
    load.modulation.trajectory.parts = {line(7.0, AtEnd::off)};
    // 98 mm at 7 m/s: 14 ms; the end lies between the steps of any of these.
    CHECK(measures::impulse_N_s(load, 20e-3) ==
          Approx(measures::impulse_N_s(steady_load(), 14e-3)).epsilon(1e-12));
    load.modulation.trajectory.parts = {line(7.0, AtEnd::hold)};
    CHECK(measures::impulse_N_s(load, 20e-3) ==
          Approx(measures::impulse_N_s(steady_load(), 20e-3)).epsilon(1e-12));
}

TEST_CASE("a modulated load delivers the integral of its envelope", "[intensity]") {
    Load load = steady_load();
    const double f = GENERATE(0.7, 50.0, 137.0, 800.0), until = 14e-3;
    load.modulation.envelope.gains = {SineGain{.frequency_Hz = f}};
    const double omega = 2.0 * std::numbers::pi * f;
    const double expected = 0.5 * until - 0.5 * std::sin(omega * until) / omega;
    // Gauss rule of two points with 100 steps per period: (2 pi / 100)^4 / 4320 = 4e-9.
    CHECK(measures::impulse_N_s(load, until) / measures::impulse_N_s(steady_load(), 1.0) ==
          Approx(expected).margin(1e-8 / omega));
}

TEST_CASE("the impulse of a steered array is the mean of its force", "[intensity][array]") {
    Load load = steady_load();
    // 28 mm in 4 ms, not symmetric to the array, which weakens the beam by 3 % at the end.
    const Vec2 from = {-0.004, 0.0}, way = {0.0224, 0.0168};
    ArrayFootprint array{.distance_m = 0.15, .reach_m = 0.03};
    array.update_rate_Hz = GENERATE(0.0, 1000.0);
    load.footprint = array;
    const auto force_at = [&](double share) {
        load.modulation.trajectory.parts = {Hold{from + share * way}};
        const double zero = 0.0;
        return forces_N(load, {&zero, 1}).front();
    };
    double mean = 0.0;
    if (array.update_rate_Hz > 0.0)
        mean = 0.25 * (force_at(0.0) + force_at(0.25) + force_at(0.5) + force_at(0.75));
    else
        for (int n = 0; n < 40; ++n) // midpoint rule: 0.03 / (24 * 40^2) = 1e-6
            mean += force_at((n + 0.5) / 40.0) / 40.0;
    load.modulation.trajectory.parts = {
        Travel{.path = {from, from + way}, .motion = ConstantSpeed{7.0}, .at_end = AtEnd::repeat}};
    const double until = 0.2; // 50 times
    CHECK(measures::impulse_N_s(load, until) == Approx(mean * until).epsilon(1e-5));
}

TEST_CASE("the impulse of an array with rounded phases is the mean of its force",
          "[intensity][array]") {
    Load load = steady_load();
    ArrayFootprint array{.columns = 6, .rows = 6, .distance_m = 0.08, .reach_m = 0.015};
    array.phase_levels = 4;
    load.footprint = array;
    const Vec2 from = {-0.004, 0.0}, way = {0.0224, 0.0168}; // 28 mm in 4 ms
    load.modulation.trajectory.parts = {
        Travel{.path = {from, from + way}, .motion = ConstantSpeed{7.0}, .at_end = AtEnd::repeat}};
    std::vector<double> times_s;
    for (int n = 0; n < 2000; ++n)
        times_s.push_back((n + 0.5) / 2000.0 * 4e-3);
    double mean = 0.0;
    for (const double force : forces_N(load, times_s))
        mean += force / 2000.0;
    // The force of these few pistons fluctuates by 6 % (rms): 3e-3 after 400 independent positions,
    // 1e-3 measured. Regular times, which repeat positions of the path, are in error by 5e-3.
    for (const double until : {0.128, 0.2})
        CHECK(measures::impulse_N_s(load, until) == Approx(mean * until).epsilon(2e-3));
}

TEST_CASE("a resolved carrier delivers the impulse of its average", "[intensity]") {
    Load load = steady_load();
    load.carrier = ResolvedCarrier{.frequency_Hz = 40e3};
    // 14 ms are 560 cycles; half a cycle more or less would be 1e-5.
    CHECK(measures::impulse_N_s(load, 14e-3) ==
          Approx(measures::impulse_N_s(steady_load(), 14e-3)).epsilon(1e-9));
}

} // namespace test_intensity
