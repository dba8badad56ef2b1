// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/load.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_load {

using namespace shearwake;

static Load plain_load() {
    Load load;
    load.peak_Pa = 100.0;
    load.footprint = GaussianFootprint{0.003};
    load.modulation.trajectory.parts = {
        Travel{{{-0.049, 0.0}, {0.049, 0.0}}, ConstantSpeed{7.0}, AtEnd::off}};
    return load;
}

TEST_CASE("a Gaussian footprint has half its pressure at half its width", "[load]") {
    const Footprint g = GaussianFootprint{0.003};
    CHECK(pressure(g, 0.0, 0.0) == 1.0);
    CHECK(pressure(g, 0.0015, 0.0) == Approx(0.5).epsilon(1e-14));
    CHECK(pressure(g, 0.0, -0.0015) == Approx(0.5).epsilon(1e-14));
    CHECK(pressure(g, 0.0009, 0.0012) == Approx(0.5).epsilon(1e-14));
    CHECK(fwhm_m(g) == 0.003);
}

TEST_CASE("a footprint and its spectrum are a Fourier pair", "[load]") {
    const Footprint g = GaussianFootprint{0.003};
    // Four points a width: what aliases is exp(-(2 pi/dx - k)^2 s^2/2) < 1e-12 of the peak for the
    // k below; the sum reaches 10 widths, exp(-277) of the peak.
    const double dx_m = 0.0005;
    const double kx = GENERATE(0.0, 300.0, 1500.0), ky = GENERATE(0.0, 700.0);
    double sum = 0.0; // the footprint is even: the sine part is zero
    for (int i = -60; i <= 60; ++i)
        for (int j = -60; j <= 60; ++j)
            sum += pressure(g, i * dx_m, j * dx_m) * std::cos(kx * i * dx_m + ky * j * dx_m);
    CHECK(sum * dx_m * dx_m ==
          Approx(spectrum(g, kx, ky)).epsilon(0).margin(1e-10 * spectrum(g, 0.0, 0.0)));
}

TEST_CASE("the bandwidth is where the spectrum has fallen to the fraction", "[load]") {
    const Footprint g = GaussianFootprint{0.003};
    const double fraction = GENERATE(0.5, 1e-2, 1e-3);
    const double k = bandwidth_rad_m(g, fraction);
    CHECK(spectrum(g, k, 0.0) == Approx(fraction * spectrum(g, 0.0, 0.0)).epsilon(1e-12));
    CHECK(spectrum(g, 0.6 * k, 0.8 * k) == Approx(fraction * spectrum(g, 0.0, 0.0)).epsilon(1e-12));
}

TEST_CASE("the force is the integral of the pressure while the path lasts", "[load]") {
    const Load load = plain_load();
    const double sigma = 0.003 / (2.0 * std::sqrt(2.0 * std::numbers::ln2));
    const double whole_N = 100.0 * 2.0 * std::numbers::pi * sigma * sigma;
    const std::vector<double> times_s = {-1e-9, 0.0, 0.0139, 0.0141};
    const std::vector<double> forces = forces_N(load, times_s);
    CHECK(forces[0] == 0.0);
    CHECK(forces[1] == Approx(whole_N).epsilon(1e-14));
    CHECK(forces[2] == Approx(whole_N).epsilon(1e-14));
    CHECK(forces[3] == 0.0);
}

TEST_CASE("a resolved carrier has mean one and is never negative", "[load]") {
    Load load = plain_load();
    load.carrier = ResolvedCarrier{40e3};
    double sum = 0.0, least = 1.0;
    for (int n = 0; n < 64; ++n) { // one period
        const double a = amplitude(load, n / (64.0 * 40e3));
        sum += a;
        least = std::min(least, a);
    }
    CHECK(sum / 64.0 == Approx(1.0).epsilon(1e-12));
    CHECK(least >= 0.0);
    CHECK(amplitude(load, 0.0) == Approx(2.0).epsilon(1e-14));
}

TEST_CASE("the averaged carrier leaves the envelope alone", "[load]") {
    Load load = plain_load();
    load.modulation.envelope.gains = {SineGain{200.0, 0.6}};
    const double t = GENERATE(0.0, 0.0013, 0.009);
    CHECK(amplitude(load, t) == gain(load.modulation.envelope, t));
}

} // namespace test_load
