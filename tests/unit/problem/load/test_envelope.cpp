// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/envelope.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_envelope {

using namespace shearwake;

TEST_CASE("a square gain is 1 for its fraction of each period", "[envelope]") {
    const SquareGain square{.frequency_Hz = 100.0, .duty = 0.3, .depth = 0.8, .edge_s = 0.0002};
    const double period = GENERATE(0.0, 1.0, 7.0) * 0.01;
    const auto at = [&](double t) { return gain({{square}}, period + t); };
    CHECK(at(0.0001) == Approx(0.2 + 0.8 * 0.5).epsilon(1e-12)); // half of the rise
    CHECK(at(0.0003) == Approx(1.0).epsilon(1e-14));
    CHECK(at(0.0029) == Approx(1.0).epsilon(1e-14));
    CHECK(at(0.0031) == Approx(0.2 + 0.8 * 0.5).epsilon(1e-12)); // half of the fall
    CHECK(at(0.0033) == Approx(0.2).epsilon(1e-13));
    CHECK(at(0.0099) == Approx(0.2).epsilon(1e-13));
}

TEST_CASE("the edges of a square gain do not change its mean", "[envelope]") {
    const SquareGain square{.frequency_Hz = 100.0, .duty = 0.3, .edge_s = 0.0004};
    double sum = 0.0; // rectangles of 1 us: their corners lie on the edges' ends
    for (int n = 0; n < 10000; ++n)
        sum += gain({{square}}, (n + 0.5) * 1e-6);
    CHECK(sum / 10000 == Approx(0.3).epsilon(1e-12));
}

TEST_CASE("a window is 1 between its times", "[envelope]") {
    const Envelope window{{WindowGain{.from_s = 0.002, .to_s = 0.006, .edge_s = 0.001}}};
    CHECK(gain(window, 0.0019) == 0.0);
    CHECK(gain(window, 0.0025) == Approx(0.5).epsilon(1e-12));
    CHECK(gain(window, 0.004) == 1.0);
    CHECK(gain(window, 0.0055) == Approx(0.5).epsilon(1e-12));
    CHECK(gain(window, 0.0061) == 0.0);
}

TEST_CASE("a ramp changes from one gain to another at its time", "[envelope]") {
    const Envelope ramp{{RampGain{.duration_s = 0.002, .start_s = 0.001, .from = 0.8, .to = 0.2}}};
    CHECK(gain(ramp, 0.0005) == Approx(0.8).epsilon(1e-14));
    CHECK(gain(ramp, 0.002) == Approx(0.5).epsilon(1e-14));
    CHECK(gain(ramp, 0.0015) ==
          Approx(0.8 - 0.6 * std::pow(std::sin(std::numbers::pi / 8.0), 2)).epsilon(1e-14));
    CHECK(gain(ramp, 0.004) == Approx(0.2).epsilon(1e-14));
}

TEST_CASE("a sampled gain is linear between its values and holds or repeats them", "[envelope]") {
    SampledGain sampled{.values = {0.2, 1.0, 0.6}, .interval_s = 1e-3};
    CHECK(gain({{sampled}}, 0.0) == 0.2);
    CHECK(gain({{sampled}}, 0.25e-3) == Approx(0.4).epsilon(1e-12));
    CHECK(gain({{sampled}}, 1.5e-3) == Approx(0.8).epsilon(1e-12));
    CHECK(gain({{sampled}}, 9e-3) == 0.6);
    CHECK(gain_frequency_Hz({{sampled}}) == 0.0);
    sampled.repeat = true;
    const double period = GENERATE(0.0, 1.0, 70.0) * 3e-3;
    CHECK(gain({{sampled}}, period + 1.5e-3) == Approx(0.8).epsilon(1e-12));
    CHECK(gain({{sampled}}, period + 2.75e-3) == Approx(0.3).epsilon(1e-12));
    CHECK(gain_frequency_Hz({{sampled}}) == Approx(1.0 / 3e-3).epsilon(1e-14));
    CHECK(greatest_envelope_frequency_Hz({{sampled}}) == Approx(500.0).epsilon(1e-14));
}

TEST_CASE("every gain on the pressure acts squared on the force", "[envelope]") {
    const Gain on_force =
        GENERATE(Gain(SquareGain{.frequency_Hz = 100.0, .depth = 0.6, .edge_s = 0.001}),
                 Gain(RampGain{.duration_s = 0.01}),
                 Gain(WindowGain{.from_s = 0.001, .to_s = 0.008, .edge_s = 0.002}),
                 Gain(SampledGain{.values = {0.1, 0.9, 0.4}, .interval_s = 0.003}));
    Gain on_pressure = on_force;
    std::visit([](auto& g) { g.on = GainOn::pressure; }, on_pressure);
    for (const double t : {0.0004, 0.0023, 0.0057, 0.0072}) {
        const double drive = gain({{on_force}}, t);
        CHECK(gain({{on_pressure}}, t) == drive * drive);
    }
    CHECK(greatest_envelope_frequency_Hz({{on_pressure}}) ==
          2.0 * greatest_envelope_frequency_Hz({{on_force}}));
}

TEST_CASE("an envelope is the product of its gains", "[envelope]") {
    const Envelope all{{SineGain{200.0, 0.5}, SquareGain{.frequency_Hz = 40.0, .edge_s = 1e-4},
                        WindowGain{.from_s = 0.0, .to_s = 0.02, .edge_s = 0.001}}};
    const double t = GENERATE(0.0007, 0.011, 0.0195);
    double product = 1.0;
    for (const Gain& g : all.gains)
        product *= gain({{g}}, t);
    CHECK(gain(all, t) == Approx(product).epsilon(1e-15));
    CHECK(gain_frequency_Hz(all) == 200.0);
    CHECK(gain({}, t) == 1.0);
}

TEST_CASE("a sine gain is its closed form at any time, depth and phase", "[envelope]") {
    // As it is typed in a job: sin and cos of the phase by the addition theorem, so that a wrong
    // sign of it shows. Roundings: some 1e-15 of 1.
    const double depth = GENERATE(0.0, 0.35, 1.0), phase_rad = GENERATE(0.7, -2.1);
    const double t = GENERATE(0.00037, 0.0123, 0.8011), two_pi_f = 2.0 * std::numbers::pi * 173.0;
    const double cosine =
        std::cos(two_pi_f * t) * std::cos(phase_rad) - std::sin(two_pi_f * t) * std::sin(phase_rad);
    const double drive = 1.0 - depth / 2.0 * (1.0 + cosine);
    const SineGain on_force{.frequency_Hz = 173.0, .depth = depth, .phase_rad = phase_rad};
    SineGain on_pressure = on_force;
    on_pressure.on = GainOn::pressure;
    CHECK(gain({{on_force}}, t) == Approx(drive).epsilon(0).margin(1e-12));
    CHECK(gain({{on_pressure}}, t) == Approx(drive * drive).epsilon(0).margin(1e-12));
}

} // namespace test_envelope
