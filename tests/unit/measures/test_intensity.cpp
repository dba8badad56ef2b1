// SPDX-License-Identifier: BSD-3-Clause
#include "measures/intensity.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace shearwake;

namespace {

Load steady_load() {
    return {.peak_Pa = 100.0,
            .footprint = GaussianFootprint{.fwhm_m = 3e-3},
            .modulation = {.trajectory = {{Hold{}}}}};
}

Travel line(double speed_m_s, AtEnd at_end) {
    return {.path = {{-49e-3, 0.0}, {49e-3, 0.0}},
            .motion = ConstantSpeed{speed_m_s},
            .at_end = at_end};
}

} // namespace

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
    // Steps of a 200th of a period: (2 pi / 200)^2 / 12 = 8e-5 of the oscillating part.
    CHECK(measures::impulse_N_s(load, until) / measures::impulse_N_s(steady_load(), 1.0) ==
          Approx(expected).margin(1e-4 / omega));
}

TEST_CASE("a resolved carrier delivers the impulse of its average", "[intensity]") {
    Load load = steady_load();
    load.carrier = ResolvedCarrier{.frequency_Hz = 40e3};
    // 14 ms are 560 cycles; half a cycle more or less would be 1e-5.
    CHECK(measures::impulse_N_s(load, 14e-3) ==
          Approx(measures::impulse_N_s(steady_load(), 14e-3)).epsilon(1e-9));
}
