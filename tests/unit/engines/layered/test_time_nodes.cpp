// SPDX-License-Identifier: BSD-3-Clause
// Quadrature in time of loads with jumps and kinks, and the response to them above the highest
// frequency of the transform, against closed forms.
#include "engines/layered/load/jump_tail.hpp"
#include "engines/layered/load/time_nodes.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <numbers>

namespace test_time_nodes {

using namespace shearwake;
using Complex = std::complex<double>;

constexpr double pi = std::numbers::pi;

/// The error of a load's spectrum at a fraction of the highest frequency, relative to the impulse.
/// The interpolation weights its error with the inverse cube of the frequency, as the response to a
/// jump decays; it is 5e-4 at the beginning of the roll-off (observed: 2e-4). Samples without nodes
/// are in error by half a step, 8e-3 of the period in these tests.
static double allowed(double of_highest) {
    return 3e-6 + 5e-4 * std::pow(of_highest / 0.8, 3);
}

/// Integral of e^{a t} over [from, to].
static Complex integral(Complex a, double from, double to) {
    return (std::exp(a * to) - std::exp(a * from)) / a;
}

/// The spectrum of a load e^{-i k x(t)} at one frequency, from the nodes, and the length of the
/// step.
static Complex by_nodes(const Case& c, const layered::TimeTransform& time, double k,
                        std::ptrdiff_t m) {
    const layered::TimeNodes nodes(c, time);
    std::vector<Complex> samples(static_cast<std::size_t>(time.samples));
    const auto value = [&](std::size_t i) {
        const double t = nodes.times_s()[i];
        return nodes.weights()[i] * strength(c.scene.load, t) *
               std::exp(Complex(-time.decay_rad_s * t, -k * focus_m(c.scene.load, t).x));
    };
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i] = value(i);
    for (std::size_t n = 0; n < static_cast<std::size_t>(nodes.nodes()); ++n)
        for (std::size_t l = 0; l < layered::taps; ++l)
            samples[(static_cast<std::size_t>(nodes.first_samples()[n]) + l) % samples.size()] +=
                nodes.coefficients()[2 * (n * layered::taps + l)] * value(samples.size() + n);
    Complex sum = 0.0;
    for (std::ptrdiff_t i = 0; i < time.samples; ++i)
        sum += samples[static_cast<std::size_t>(i)] *
               std::polar(1.0, -2.0 * pi * static_cast<double>(m * i % time.samples) /
                                   static_cast<double>(time.samples));
    // The first sample is at first_s.
    const double omega =
        2.0 * pi * static_cast<double>(m) / (static_cast<double>(time.samples) * time.step_s);
    return time.step_s * sum * std::polar(1.0, -omega * time.first_s);
}

TEST_CASE("jumps of a cubic and its derivatives are exact", "[layered][time_nodes]") {
    std::vector<Complex> values(2 * layered::jump_orders, 0.0); // 0 before the break
    for (std::ptrdiff_t i = 0; i < layered::jump_orders; ++i) {
        const double t = static_cast<double>(i) / 64.0;
        values[static_cast<std::size_t>(layered::jump_orders + i)] =
            1.0 + t * (2.0 + t * (3.0 + t * 4.0));
    }
    const auto found = layered::jumps(values.data());
    const double exact[] = {1.0, 2.0, 6.0, 24.0};
    for (std::size_t q = 0; q < found.size(); ++q)
        CHECK(std::abs(found[q] - exact[q]) < 1e-8); // rounding, times up to 64^3
}

TEST_CASE("a line that is drawn again and again has its exact harmonics", "[layered][time_nodes]") {
    const double speed = 7.0, length = 20e-3, period_s = length / speed;
    Case c = test::moving_focus(test::half_space(test::tissue()), {});
    c.scene.load.footprint = GaussianFootprint{4e-3};
    c.scene.load.modulation.trajectory.parts = {
        Travel{Line{{-1e-2, 0.0}, {1e-2, 0.0}}, ConstantSpeed{speed}, AtEnd::repeat}};
    c.time = {64, period_s / 64.0, Regime::periodic};
    layered::TimeTransform time;
    time.samples = 64;
    time.step_s = time.first_s = period_s / 64.0;
    const double sigma_m = 4e-3 / (2.0 * std::sqrt(2.0 * std::numbers::ln2));
    for (const double k : {0.0, 0.3 / sigma_m, -1.0 / sigma_m, 2.0 / sigma_m})
        for (const std::ptrdiff_t m : {0, 1, 2, 5, 9, 14, 19, 24}) {
            const double omega = 2.0 * pi * static_cast<double>(m) / period_s;
            const Complex rate(0.0, -k * speed - omega);
            const Complex exact = std::abs(rate) < 1e-9
                                      ? std::polar(period_s, k * 1e-2)
                                      : std::polar(1.0, k * 1e-2) * integral(rate, 0.0, period_s);
            INFO("k sigma = " << k * sigma_m << ", harmonic " << m);
            CHECK(std::abs(by_nodes(c, time, k, m) - exact) <
                  allowed(static_cast<double>(m) / 32.0) * period_s);
        }
}

TEST_CASE("the start and the end of a path are integrated exactly", "[layered][time_nodes]") {
    const double speed = 5.0, off_s = 17.3e-3 / speed; // between two samples
    Case c = test::moving_focus(test::half_space(test::tissue()), {});
    c.scene.load.footprint = GaussianFootprint{4e-3};
    c.scene.load.modulation.trajectory.parts = {
        Travel{Line{{-1e-2, 0.0}, {7.3e-3, 0.0}}, ConstantSpeed{speed}, AtEnd::off}};
    c.time = {80, 50e-6};
    layered::TimeTransform time;
    time.samples = 160;
    time.step_s = 50e-6;
    time.decay_rad_s = std::log(1e6) / 8e-3;
    for (const double k : {0.0, 200.0, -900.0})
        for (const std::ptrdiff_t m : {0, 3, 17, 40}) {
            const double omega = 2.0 * pi * static_cast<double>(m) / 8e-3;
            const Complex rate(-time.decay_rad_s, -k * speed - omega);
            const Complex exact = std::polar(1.0, k * 1e-2) * integral(rate, 0.0, off_s);
            CHECK(std::abs(by_nodes(c, time, k, m) - exact) <
                  allowed(static_cast<double>(m) / 80.0) *
                      std::abs(integral(-time.decay_rad_s, 0.0, off_s)));
        }
}

TEST_CASE("the removed part and the low-pass filtered part add up", "[layered][jump_tail]") {
    // A signal that is s^{q-1}/(q-1)! e^{-d s} after s = 0 has the spectrum (d + i x)^{-q}. Its
    // filtered part follows from an integral over the band, the removed part from the powers of
    // 1/(i x) as a series in d. Their sum is the signal.
    const double d = 0.02;
    for (const int q : {1, 2, 3})
        for (const double s : {-6.3, -1.0, -0.2, 0.3, 1.0, 2.7, 9.1}) {
            constexpr int points = 200000;
            double filtered = 0.0;
            for (int i = 0; i < points; ++i) {
                const double x = pi * (i + 0.5) / points;
                filtered += (layered::roll_off(x / pi) * std::pow(Complex(d, x), -q) *
                             std::polar(1.0, x * s))
                                .real() /
                            points;
            }
            double removed = 0.0, term = 1.0;
            for (int a = 0; q + a <= 8; ++a) {
                removed += term * layered::removed_part(q + a, s);
                term *= -d * (q + a) / (a + 1.0);
            }
            const double exact =
                s < 0.0 ? 0.0 : std::pow(s, q - 1) / std::tgamma(q) * std::exp(-d * s);
            INFO("q = " << q << ", s = " << s);
            // Both parts are tabulated or integrated to about 1e-6; q = 3 leaves out frequencies
            // beyond 40 pi, 1e-5.
            CHECK(std::abs(filtered + removed - exact) < 2e-5);
        }
}

TEST_CASE("powers of 1/frequency are fitted exactly", "[layered][jump_tail]") {
    const layered::TailFit fit(560, layered::StackQuantity::compression);
    const double truth[] = {0.5, -0.3, 2.0, 1.0, -4.0, 3.0};
    Eigen::VectorXd h(fit.matrix().cols());
    for (std::size_t i = 0; i < fit.frequencies().size(); ++i) {
        const Complex x(0.0, 2.0 * pi * static_cast<double>(fit.frequencies()[i]) / 560.0);
        Complex sum = 0.0;
        for (int a = 0; a < 6; ++a)
            sum += truth[a] * std::pow(x, -a);
        h(static_cast<Eigen::Index>(2 * i)) = sum.real();
        h(static_cast<Eigen::Index>(2 * i + 1)) = sum.imag();
    }
    const Eigen::VectorXd found = fit.matrix() * h;
    for (int a = 0; a < 6; ++a)
        CHECK(found(a) ==
              Approx(truth[a]).epsilon(1e-8)); // rounding times the condition number, 1e6
}

} // namespace test_time_nodes
