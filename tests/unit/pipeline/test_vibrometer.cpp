// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/vibrometer.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_vibrometer {

using namespace shearwake;

constexpr double full_circle_rad = 2.0 * std::numbers::pi;

/// Frames every 50 us for 20 ms, and one point.
static Case measured(const VibrometerOptions& options) {
    Case c;
    c.time = {.frames = 400, .interval_s = 5e-5};
    c.vibrometer = options;
    return c;
}

static VibrometerOptions points(std::size_t count) {
    VibrometerOptions options;
    for (std::size_t n = 0; n < count; ++n)
        options.points_m.push_back({1e-3 * static_cast<double>(n), 0.0});
    return options;
}

/// A displacement that starts smoothly at t = 0, and its velocity.
static double displacement(double t) {
    return 1e-6 * std::pow(t / 2e-3, 4) * std::exp(-t / 2e-3) *
           std::sin(full_circle_rad * 200.0 * t);
}
static double velocity(double t) {
    constexpr double h = 1e-7;
    return (displacement(t + h) - displacement(t - h)) / (2.0 * h);
}

static std::vector<double> displacements(const Case& c) {
    std::vector<double> all;
    for (std::size_t p = 0; p < c.vibrometer->points_m.size(); ++p)
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
            all.push_back(displacement(c.time.frame_s(n)));
    return all;
}

TEST_CASE("the vibrometer records the derivative of the displacement", "[vibrometer]") {
    VibrometerOptions options = points(1);
    options.rate_Hz = GENERATE(0.0, 7e3, 51.2e3);
    options.trigger_delay_s = GENERATE(0.0, 1.3e-3, -2e-3);
    const Case c = measured(options);
    const auto recorded = pipeline::scan(c, displacements(c));
    REQUIRE(recorded.velocity_m_s.size() == recorded.time_s.size());
    CHECK(recorded.time_s.back() + options.trigger_delay_s == Approx(0.02).margin(1.5e-4));
    double worst = 0.0, peak = 0.0;
    for (std::size_t n = 0; n < recorded.time_s.size(); ++n) {
        const double t = recorded.time_s[n] + options.trigger_delay_s;
        const double exact = t > 0.0 ? velocity(t) : 0.0;
        worst = std::max(worst, std::abs(recorded.velocity_m_s[n] - exact));
        peak = std::max(peak, std::abs(exact));
    }
    CHECK(worst < 2e-5 * peak); // polynomials of degree 5, 100 frames per period
    CHECK(recorded.quality.front() == 1.0);
}

TEST_CASE("the recorded velocity depends smoothly on the trigger delay", "[vibrometer]") {
    Case c = measured(points(1)); // one sample per frame
    c.time.regime = GENERATE(Regime::transient, Regime::periodic);
    std::vector<double> u; // 12 frames per period, of which 396 are in whole periods
    c.time.frames = 396;
    const double omega = full_circle_rad / (12.0 * c.time.interval_s);
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        u.push_back(1.0 - std::cos(omega * c.time.frame_s(n)));
    const auto sample = [&](double delay_s) {
        c.vibrometer->trigger_delay_s = delay_s;
        return pipeline::scan(c, u).velocity_m_s.at(50);
    };
    const double step_s = 1e-8, at = sample(0.0);
    const double after = (sample(step_s) - at) / step_s, before = (at - sample(-step_s)) / step_s;
    // 50 frames are 25/6 periods. The slope at a frame is in error by (omega h)^6 / 140 = 1.5e-4,
    // differences of step_s by omega step_s = 1e-4.
    CHECK(at == Approx(omega * std::sin(omega * 50.0 * c.time.interval_s)).epsilon(3e-4));
    CHECK(after == Approx(before).epsilon(1e-3));
    CHECK(after ==
          Approx(omega * omega * std::cos(omega * 50.0 * c.time.interval_s)).epsilon(1e-2));
}

TEST_CASE("the motion begins without velocity", "[vibrometer]") {
    const Case c = measured(points(1));
    std::vector<double> u; // a speed of 0.01 m/s from the start: three frames later it is recorded
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        u.push_back(0.01 * c.time.frame_s(n));
    const std::vector<double> v = pipeline::scan(c, u).velocity_m_s;
    CHECK(std::abs(v[0]) < 1e-15); // rounding
    CHECK(v[3] == Approx(0.01));
}

TEST_CASE("the noise of the vibrometer has the given density", "[vibrometer]") {
    VibrometerOptions options = points(200);
    options.noise_m_s_rtHz = 1e-6;
    options.averages = 4;
    const Case c = measured(options);
    const std::vector<double> rest(200 * 400, 0.0);
    const auto recorded = pipeline::scan(c, rest);
    double sum = 0.0;
    for (const double v : recorded.velocity_m_s)
        sum += v * v;
    const double expected = 1e-12 * 1e4 / 4.0; // density squared times 10 kHz, averaged
    // 80 000 samples: the standard deviation of the mean square is 0.5 %.
    CHECK(sum / static_cast<double>(recorded.velocity_m_s.size()) ==
          Approx(expected).epsilon(0.025));
    CHECK(recorded.velocity_m_s == pipeline::scan(c, rest).velocity_m_s);
    VibrometerOptions other = options;
    other.seed = 2;
    CHECK(recorded.velocity_m_s != pipeline::scan(measured(other), rest).velocity_m_s);
}

TEST_CASE("missing points return no signal", "[vibrometer]") {
    VibrometerOptions options = points(50);
    options.missing_share = 0.1;
    const Case c = measured(options);
    const auto recorded = pipeline::scan(c, displacements(c));
    int missing = 0;
    for (std::size_t p = 0; p < 50; ++p) {
        const bool is_missing = std::isnan(recorded.velocity_m_s[p * recorded.time_s.size()]);
        missing += is_missing;
        CHECK((recorded.quality[p] == 0.0) == is_missing);
    }
    CHECK(missing == 5);
}

TEST_CASE("filters of the vibrometer pass their band", "[vibrometer]") {
    VibrometerOptions options = points(1);
    const double frequency_Hz = GENERATE(50.0, 200.0, 1000.0);
    options.high_pass_Hz = 100.0;
    options.low_pass_Hz = 500.0;
    Case c = measured(options);
    c.time.regime = Regime::periodic;
    std::vector<double> u;
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        u.push_back(std::sin(full_circle_rad * frequency_Hz * c.time.frame_s(n)));
    const auto recorded = pipeline::scan(c, u);
    REQUIRE(recorded.time_s.size() == 400);
    double sum = 0.0;
    for (const double v : recorded.velocity_m_s)
        sum += v * v / 400.0;
    // The analog filters; the bilinear transform shifts 1 kHz by 1 % at 20 kHz.
    const double high = std::pow(frequency_Hz / 100.0, 4), low = std::pow(frequency_Hz / 500.0, 4);
    const double expected =
        full_circle_rad * frequency_Hz * std::sqrt(0.5 * high / (1.0 + high) / (1.0 + low));
    CHECK(std::sqrt(sum) == Approx(expected).epsilon(0.02));
}

} // namespace test_vibrometer
