// SPDX-License-Identifier: BSD-3-Clause
#include "measures/spectrum.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace test_spectrum {

using namespace shearwake;

constexpr double dt = 50e-6;
constexpr double two_pi = 2.0 * std::numbers::pi;

static std::vector<double> tone(double amplitude, double frequency_Hz, double phase,
                                std::size_t samples) {
    std::vector<double> u;
    for (std::size_t n = 0; n < samples; ++n)
        u.push_back(amplitude *
                    std::cos(two_pi * frequency_Hz * dt * static_cast<double>(n + 1) + phase));
    return u;
}

static double rms(const std::vector<double>& u) {
    double sum = 0.0;
    for (const double v : u)
        sum += v * v;
    return std::sqrt(sum / static_cast<double>(u.size()));
}

TEST_CASE("a tone of whole periods shows its amplitude at its frequency", "[spectrum]") {
    const double phase = GENERATE(0.0, 0.7, 2.5);
    const std::vector<double> u = tone(3e-6, 200.0, phase, 400); // 20 ms: four periods
    const std::vector<double> f = {0.0, 150.0, 200.0, 250.0};
    const std::vector<double> a = measures::amplitude_spectrum(u, dt, f);
    // Orthogonal on the samples: rounding of 400 additions.
    CHECK(a[2] == Approx(3e-6).epsilon(1e-12));
    CHECK(a[0] == Approx(0.0).margin(1e-18));
    CHECK(a[1] == Approx(0.0).margin(1e-18));
    CHECK(a[3] == Approx(0.0).margin(1e-18));
}

TEST_CASE("the amplitude at zero frequency is the mean", "[spectrum]") {
    const std::vector<double> u(100, 2.5);
    CHECK(measures::amplitude_spectrum(u, dt, std::vector<double>{0.0})[0] ==
          Approx(2.5).epsilon(1e-14));
}

TEST_CASE("above the Nyquist frequency there is no amplitude", "[spectrum]") {
    const std::vector<double> a = measures::amplitude_spectrum(tone(1.0, 100.0, 0.0, 100), 1e-3,
                                                               std::vector<double>{500.0, 501.0});
    CHECK_FALSE(std::isnan(a[0]));
    CHECK(std::isnan(a[1]));
}

TEST_CASE("the spectrum of a long trace agrees with the direct sum", "[spectrum]") {
    const std::vector<double> u = tone(1.0, 333.0, 0.3, 5000);
    const double f = 331.7;
    double re = 0.0, im = 0.0;
    for (std::size_t n = 0; n < u.size(); ++n) {
        re += u[n] * std::cos(two_pi * f * dt * static_cast<double>(n + 1));
        im -= u[n] * std::sin(two_pi * f * dt * static_cast<double>(n + 1));
    }
    CHECK(measures::amplitude_spectrum(u, dt, std::vector<double>{f})[0] ==
          Approx(2.0 / 5000.0 * std::hypot(re, im)).epsilon(1e-11)); // phasors of 1e-14
}

TEST_CASE("the frequencies of a spectrum are fine and round", "[spectrum]") {
    const auto step = [](double duration_s) {
        return measures::spectrum_frequencies_Hz(duration_s)[1];
    };
    CHECK(step(14e-3) == Approx(10.0)); // 1/4T = 17.9 Hz
    CHECK(step(25e-3) == Approx(10.0));
    CHECK(step(40e-3) == Approx(5.0)); // 6.25 Hz
    CHECK(step(100e-3) == Approx(2.0));
    CHECK(step(1.0) == Approx(0.2));
    const std::vector<double> f = measures::spectrum_frequencies_Hz(14e-3);
    CHECK(f.size() == 201);
    CHECK(f.front() == 0.0);
    CHECK(f.back() == Approx(2000.0));
}

TEST_CASE("the peak frequency of a tone is found between the points of the spectrum",
          "[spectrum]") {
    const double frequency = GENERATE(201.3, 347.0, 803.9);
    const std::vector<double> u = tone(1.0, frequency, 0.4, 2000);        // 100 ms
    const std::vector<double> f = measures::spectrum_frequencies_Hz(0.1); // every 2 Hz
    // The main lobe is 20 Hz wide; a parabola is off by 1 % of it, and the image at -f leaks 0.1
    // Hz.
    CHECK(measures::peak_frequency_Hz(f, measures::amplitude_spectrum(u, dt, f), 10.0) ==
          Approx(frequency).margin(0.2));
}

TEST_CASE("a parabola's vertex is found exactly", "[spectrum]") {
    const std::vector<double> f = {10.0, 20.0, 25.0, 40.0};
    std::vector<double> a;
    for (const double x : f)
        a.push_back(5.0 - 0.01 * (x - 22.0) * (x - 22.0));
    CHECK(measures::peak_frequency_Hz(f, a, 15.0) == Approx(22.0).epsilon(1e-13));
}

TEST_CASE("a monotonically falling spectrum has no peak frequency", "[spectrum]") {
    const std::vector<double> f = {0.0, 10.0, 20.0, 30.0};
    CHECK(
        std::isnan(measures::peak_frequency_Hz(f, std::vector<double>{4.0, 3.0, 2.0, 1.0}, 10.0)));
    CHECK(
        std::isnan(measures::peak_frequency_Hz(f, std::vector<double>{1.0, 2.0, 3.0, 4.0}, 10.0)));
    CHECK(
        std::isnan(measures::peak_frequency_Hz(f, std::vector<double>{0.0, 0.0, 0.0, 0.0}, 10.0)));
    // Drift below the lowest frequency does not hide a peak above it.
    CHECK(measures::peak_frequency_Hz(f, std::vector<double>{9.0, 1.0, 2.0, 1.0}, 10.0) ==
          Approx(20.0));
}

TEST_CASE("the full band holds the rms of the samples", "[spectrum]") {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.2e-6, 1e-6);
    std::vector<double> u(281);
    for (double& v : u)
        v = noise(random);
    // Parseval: the sines of the closed form vanish at 1/(2 dt) to 1e-16 each.
    CHECK(measures::band_rms(u, dt, 0.0, 0.5 / dt) == Approx(rms(u)).epsilon(1e-13));
    // Squares of the rms of bands that do not overlap add up.
    const double low = measures::band_rms(u, dt, 0.0, 777.0),
                 high = measures::band_rms(u, dt, 777.0, 0.5 / dt);
    CHECK(std::hypot(low, high) == Approx(rms(u)).epsilon(1e-12));
}

TEST_CASE("a band's rms is the integral of the spectrum over it", "[spectrum]") {
    const std::vector<double> u = tone(1.0, 130.0, 1.1, 280);
    const double duration = 280 * dt, df = 0.05;
    std::vector<double> f;
    for (double x = 40.0 + 0.5 * df; x < 400.0; x += df)
        f.push_back(x);
    double sum = 0.0;
    for (const double a : measures::amplitude_spectrum(u, dt, f))
        sum += 0.25 * a * a * duration * duration * df;
    // Midpoint rule on a function of width 1/T = 71 Hz: (0.05/71)^2.
    CHECK(measures::band_rms(u, dt, 40.0, 400.0) ==
          Approx(std::sqrt(2.0 / duration * sum)).epsilon(1e-6));
}

TEST_CASE("a long tone lies in its band and in no other", "[spectrum]") {
    const std::vector<double> u = tone(std::numbers::sqrt2, 200.0, 0.0, 4000); // 0.2 s
    // What leaks out of the band falls with distance times T: 1/(pi^2 160 Hz 0.2 s) = 0.3 %.
    CHECK(measures::band_rms(u, dt, 40.0, 400.0) == Approx(1.0).epsilon(4e-3));
    CHECK(measures::band_rms(u, dt, 500.0, 800.0) < 0.04);
}

} // namespace test_spectrum
