// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/load.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_modulation {

using namespace shearwake;

constexpr double two_pi = 2.0 * std::numbers::pi;

static Trajectory travel(Motion motion, AtEnd at_end = AtEnd::off) {
    return {{Travel{{{-0.049, 0.01}, {0.049, 0.01}}, motion, at_end}}};
}

/// Gauss-Legendre with 5 points on each of n pieces: exact to rounding for smooth integrands.
template <class F>
double integral(F f, double a, double b, int n) {
    const double x1 = std::sqrt(5.0 - 2.0 * std::sqrt(10.0 / 7.0)) / 3.0,
                 x2 = std::sqrt(5.0 + 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
    const double w0 = 128.0 / 225.0, w1 = (322.0 + 13.0 * std::sqrt(70.0)) / 900.0,
                 w2 = (322.0 - 13.0 * std::sqrt(70.0)) / 900.0;
    double sum = 0.0;
    const double half = 0.5 * (b - a) / n;
    for (int i = 0; i < n; ++i) {
        const double c = a + (2 * i + 1) * half;
        sum += w0 * f(c) + w1 * (f(c - x1 * half) + f(c + x1 * half)) +
               w2 * (f(c - x2 * half) + f(c + x2 * half));
    }
    return sum * half;
}

TEST_CASE("a focus that holds stays where it is", "[modulation]") {
    const Trajectory t{{Hold{{0.001, -0.002}}}};
    CHECK(position(t, 0.0) == Vec2{0.001, -0.002});
    CHECK(position(t, 1.0) == Vec2{0.001, -0.002});
    CHECK(velocity(t, 0.5) == Vec2{});
    CHECK(std::isinf(off_time_s(t)));
    CHECK(greatest_speed_m_s(t) == 0.0);
}

TEST_CASE("parts of a trajectory add", "[modulation]") {
    const Trajectory t{{Hold{{0.001, 0.0}}, Travel{{{0.0, 0.0}, {0.0, 0.1}}, ConstantSpeed{2.0}}}};
    CHECK(position(t, 0.01).x == Approx(0.001).epsilon(1e-15));
    CHECK(position(t, 0.01).y == Approx(0.02).epsilon(1e-15));
}

TEST_CASE("a path at constant speed is run through once", "[modulation]") {
    const Trajectory off = travel(ConstantSpeed{7.0}),
                     hold = travel(ConstantSpeed{7.0}, AtEnd::hold);
    CHECK(off_time_s(off) == Approx(0.014).epsilon(1e-14));
    CHECK(std::isinf(off_time_s(hold)));
    CHECK(position(off, 0.007).x == Approx(0.0).margin(1e-15));
    CHECK(position(off, 0.007).y == Approx(0.01).epsilon(1e-14));
    CHECK(position(off, 0.016).x == Approx(0.063).epsilon(1e-13)); // on along the tangent
    CHECK(position(hold, 0.016).x == Approx(0.049).epsilon(1e-14));
    CHECK(velocity(off, 0.003).x == Approx(7.0).epsilon(1e-14));
    CHECK(velocity(hold, 0.016) == Vec2{});
}

TEST_CASE("an oscillating speed integrates to the position", "[modulation]") {
    const double frequency_Hz = GENERATE(50.0, 200.0, 800.0);
    const double phase = GENERATE(0.0, 1.1, -2.5);
    const OscillatingSpeed motion{7.0, 2.0, frequency_Hz, phase};
    const auto speed = [&](double t) {
        return 7.0 + 2.0 * std::sin(two_pi * frequency_Hz * t + phase);
    };
    for (const double t : {1e-6, 0.001, 0.0123}) {
        CHECK(speed_m_s(Motion{motion}, t) == Approx(speed(t)).epsilon(1e-14));
        // 400 pieces: at most a twentieth of a radian each, error far below 1e-14.
        CHECK(arc_length_m(Motion{motion}, t) ==
              Approx(integral(speed, 0.0, t, 400)).epsilon(1e-12));
        const double swing_m = 2.0 / (two_pi * frequency_Hz);
        const double x = -0.049 + 7.0 * t +
                         swing_m * (std::cos(phase) - std::cos(two_pi * frequency_Hz * t + phase));
        CHECK(position(travel(motion), t).x == Approx(x).margin(1e-14).epsilon(1e-12));
    }
}

TEST_CASE("the velocity is the derivative of the position", "[modulation]") {
    const Trajectory t = travel(OscillatingSpeed{7.0, 2.0, 200.0, 0.4});
    for (const double at : {0.001, 0.0037, 0.0101}) {
        const double h = 1e-6; // error of the fourth-order difference: (2 pi 200 h)^4 ~ 1e-12
        const auto x = [&](double s) { return position(t, s).x; };
        const double slope =
            (8.0 * (x(at + h) - x(at - h)) - (x(at + 2 * h) - x(at - 2 * h))) / (12.0 * h);
        CHECK(velocity(t, at).x == Approx(slope).epsilon(1e-9));
    }
}

TEST_CASE("the focus is switched off at the end of a path with oscillating speed", "[modulation]") {
    const double frequency_Hz = GENERATE(37.0, 100.0, 200.0, 930.0);
    const double deviation = GENERATE(0.5, 2.0, 6.9);
    const Trajectory t = travel(OscillatingSpeed{7.0, deviation, frequency_Hz, 0.7});
    const double off_s = off_time_s(t);
    CHECK(position(t, off_s).x == Approx(0.049).margin(1e-13));
    CHECK(position(t, off_s - 1e-6).x < 0.049);
    CHECK(greatest_speed_m_s(t) == Approx(7.0 + deviation).epsilon(1e-15));
}

TEST_CASE("a held end is reached without a jump", "[modulation]") {
    const Trajectory t = travel(OscillatingSpeed{7.0, 2.0, 200.0, 0.7}, AtEnd::hold);
    const Trajectory off = travel(OscillatingSpeed{7.0, 2.0, 200.0, 0.7});
    const double end_s = off_time_s(off);
    CHECK(position(t, end_s + 1e-9).x == Approx(position(t, end_s - 1e-9).x).margin(1e-7));
    CHECK(position(t, end_s + 1.0).x == Approx(0.049).epsilon(1e-12));
}

TEST_CASE("the modulation frequency is that of the first periodic part", "[modulation]") {
    const Trajectory plain = travel(ConstantSpeed{7.0});
    const Trajectory swinging = travel(OscillatingSpeed{7.0, 2.0, 150.0, 0.0});
    CHECK(modulation_frequency_Hz({"STM", plain, {}}) == std::nullopt);
    CHECK(modulation_frequency_Hz({"STM", plain, {{RampGain{0.001}}}}) == std::nullopt);
    CHECK(modulation_frequency_Hz({"AM-STM", plain, {{SineGain{200.0}}}}) == 200.0);
    CHECK(modulation_frequency_Hz({"AM-STM", plain, {{SineGain{200.0, 0.0}}}}) == std::nullopt);
    CHECK(modulation_frequency_Hz({"SM-STM", swinging, {}}) == 150.0);
    CHECK(modulation_frequency_Hz({"both", swinging, {{SineGain{200.0}}}}) == 200.0);
}

TEST_CASE("a gain on the pressure doubles the frequency on the force", "[modulation]") {
    CHECK(greatest_envelope_frequency_Hz({}) == 0.0);
    CHECK(greatest_envelope_frequency_Hz({{SineGain{200.0}}}) == 200.0);
    // A gain that does not vary has no frequency: a constant force is the same however it is
    // written.
    CHECK(greatest_envelope_frequency_Hz({{SineGain{200.0, 0.0}}}) == 0.0);
    CHECK(greatest_envelope_frequency_Hz({{SquareGain{200.0, 0.5, 0.0, 0.0, 1e-3}}}) == 0.0);
    CHECK(greatest_envelope_frequency_Hz({{SineGain{200.0, 1.0, 0.0, GainOn::pressure}}}) == 400.0);
}

} // namespace test_modulation
