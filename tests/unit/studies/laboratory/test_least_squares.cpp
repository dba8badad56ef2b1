// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/least_squares.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

namespace test_least_squares {

using namespace shearwake;
using laboratory::FitResult;
using laboratory::Parameter;

namespace {

constexpr std::size_t wave_points = 30, wave_samples = 60;
constexpr double wave_speed = 2.5, wave_decay = 15.0;

/// A decaying wave of 200 Hz along a line of 60 mm.
std::optional<std::vector<double>> decaying_wave(std::span<const double> values) {
    std::vector<double> rows;
    const double omega = 2.0 * std::numbers::pi * 200.0;
    for (std::size_t point = 0; point < wave_points; ++point)
        for (std::size_t n = 0; n < wave_samples; ++n) {
            const double x = 2e-3 * static_cast<double>(point), t = 2e-4 * static_cast<double>(n);
            rows.push_back(std::exp(-values[1] * x) * std::sin(omega * (t - x / values[0])));
        }
    return rows;
}

const std::vector<Parameter>& wave_parameters() {
    static const std::vector<Parameter> parameters = {{"speed", 2.3, 1.0, 5.0},
                                                      {"decay", 10.0, 0.0, 100.0}};
    return parameters;
}

/// Noise of a standard deviation of 0.1, either white or a moving average of five samples.
std::vector<double> noisy_wave(unsigned seed, bool coloured) {
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    const std::vector<double> truth{wave_speed, wave_decay};
    std::vector<double> rows = *decaying_wave(truth);
    for (std::size_t point = 0; point < wave_points; ++point) {
        std::vector<double> white(wave_samples + 4);
        for (double& value : white)
            value = normal(generator);
        for (std::size_t n = 0; n < wave_samples; ++n) {
            double noise = white[n];
            if (coloured) {
                for (std::size_t i = 1; i < 5; ++i)
                    noise += white[n + i];
                noise /= std::sqrt(5.0);
            }
            rows[point * wave_samples + n] += 0.1 * noise;
        }
    }
    return rows;
}

bool holds(const laboratory::Estimate& estimate, double truth) {
    return estimate.low_95 <= truth && truth <= estimate.high_95;
}

} // namespace

TEST_CASE("the true values lie in the 95 % intervals of 90 of 100 seeds", "[laboratory][ceres]") {
    // Of a binomial distribution with 95 %, 88 or fewer of 100 occur once in 230 times.
    for (const bool coloured : {false, true}) {
        int speeds = 0, decays = 0;
        for (unsigned seed = 0; seed < 100; ++seed) {
            const FitResult result = laboratory::fit(wave_parameters(), noisy_wave(seed, coloured),
                                                     wave_points, decaying_wave);
            CHECK(result.has_converged);
            speeds += holds(result.estimates[0], wave_speed);
            decays += holds(result.estimates[1], wave_decay);
        }
        INFO("coloured " << coloured);
        CHECK(speeds >= 90);
        CHECK(decays >= 90);
    }
}

TEST_CASE("points with a wrong signal change the estimates little", "[laboratory][ceres]") {
    std::vector<double> rows = noisy_wave(7, false);
    for (const std::size_t point : {4u, 11u, 23u})
        for (std::size_t n = 0; n < wave_samples; ++n)
            rows[point * wave_samples + n] = n % 2 == 0 ? 3.0 : -2.0;
    const FitResult result = laboratory::fit(wave_parameters(), rows, wave_points, decaying_wave);
    CHECK(std::abs(result.estimates[0].value - wave_speed) < 0.02 * wave_speed);
    CHECK(std::abs(result.estimates[1].value - wave_decay) < 0.1 * wave_decay);
    CHECK(result.weights[11] < 0.05);
    CHECK(result.weights[12] > 0.5);
    CHECK(result.noise == Approx(0.1).epsilon(0.1)); // the median of 30 points
}

TEST_CASE("priors and bounds limit the estimates", "[laboratory][ceres]") {
    const std::vector<double> rows = noisy_wave(1, false);
    std::vector<Parameter> parameters = wave_parameters();
    parameters[1].high = 12.0;
    const FitResult bounded = laboratory::fit(parameters, rows, wave_points, decaying_wave);
    CHECK(bounded.estimates[1].value == Approx(12.0));
    CHECK(bounded.estimates[1].is_at_bound);
    parameters = wave_parameters();
    parameters[1].prior = {11.0, 1e-3, false};
    const FitResult informed = laboratory::fit(parameters, rows, wave_points, decaying_wave);
    CHECK(informed.estimates[1].value == Approx(11.0).margin(0.01));
    CHECK(informed.estimates[1].standard_error < 1.1e-3);
    parameters[1].prior = {std::log(11.0), 1e-4, true};
    const FitResult logarithmic = laboratory::fit(parameters, rows, wave_points, decaying_wave);
    CHECK(logarithmic.estimates[1].value == Approx(11.0).margin(0.01));
}

TEST_CASE("a known noise is used instead of that of the residuals", "[laboratory][ceres]") {
    const std::vector<double> rows = noisy_wave(3, false);
    const auto fitted = [&](std::optional<double> noise) {
        return laboratory::fit(wave_parameters(), rows, wave_points, decaying_wave, noise);
    };
    const FitResult own = fitted(std::nullopt), known = fitted(0.1), large = fitted(1.0);
    CHECK(known.noise == 0.1);
    CHECK(large.noise == 1.0);
    // Each point contributes 4 samples log(1 + 1 / 4) at its expected residual.
    const double expected = 4.0 * std::log(1.25) * static_cast<double>(rows.size());
    CHECK(known.chi_squared == Approx(expected).epsilon(0.1)); // 3 % of 1800 samples, and more
    CHECK(large.chi_squared == Approx(0.01 * static_cast<double>(rows.size())).epsilon(0.1));
    // Robust intervals depend on the residuals and not on the noise, apart from the weights.
    CHECK(large.estimates[0].standard_error ==
          Approx(own.estimates[0].standard_error).epsilon(0.2));
    CHECK(std::abs(large.estimates[0].value - own.estimates[0].value) <
          0.5 * own.estimates[0].standard_error);
}

TEST_CASE("a parameter that few points determine has a wide interval", "[laboratory][ceres]") {
    // The level of three points and that of the other 27.
    const auto levels = [](std::span<const double> values) {
        std::vector<double> rows(wave_points * wave_samples, values[1]);
        std::fill_n(rows.begin(), 3 * wave_samples, values[0]);
        return std::optional(rows);
    };
    const std::vector<double> waves = *decaying_wave(std::vector{wave_speed, wave_decay});
    int held = 0;
    for (unsigned seed = 0; seed < 100; ++seed) {
        std::vector<double> rows = noisy_wave(seed, true);
        for (std::size_t n = 0; n < rows.size(); ++n)
            rows[n] += 1.0 - waves[n];
        const FitResult result = laboratory::fit(
            {{"three", 0.9, 0.0, 2.0}, {"others", 0.9, 0.0, 2.0}}, rows, wave_points, levels);
        const laboratory::Estimate &three = result.estimates[0], &others = result.estimates[1];
        // Quantiles of Student's distribution with 3 and 27 degrees of freedom.
        CHECK(three.high_95 - three.value == Approx(3.18 * three.standard_error).epsilon(0.05));
        CHECK(others.high_95 - others.value == Approx(2.05 * others.standard_error).epsilon(0.02));
        held += holds(three, 1.0);
    }
    CHECK(held >= 90);
}

TEST_CASE("data without noise give the exact values", "[laboratory][ceres]") {
    const std::vector<double> truth{wave_speed, wave_decay};
    const FitResult result =
        laboratory::fit(wave_parameters(), *decaying_wave(truth), wave_points, decaying_wave);
    CHECK(result.estimates[0].value == Approx(wave_speed).epsilon(1e-5)); // tolerance of the solver
    CHECK(result.estimates[1].value == Approx(wave_decay).epsilon(1e-4));
}

TEST_CASE("a parameter without effect and a model that fails are rejected", "[laboratory][ceres]") {
    const std::vector<double> rows = noisy_wave(1, false);
    std::vector<Parameter> parameters = wave_parameters();
    parameters.push_back({"unused", 1.0, 0.0, 2.0});
    CHECK_THROWS_AS(laboratory::fit(parameters, rows, wave_points, decaying_wave), UsageError);
    CHECK_THROWS_AS(
        laboratory::fit(wave_parameters(), rows, wave_points, [](auto) { return std::nullopt; }),
        UsageError);
}

TEST_CASE("half widths are quantiles of Student's t distribution", "[laboratory]") {
    CHECK(laboratory::half_width_95(1.0) == Approx(12.7062047).epsilon(1e-8)); // tables
    CHECK(laboratory::half_width_95(1e6) == Approx(1.9599664).epsilon(1e-5));
}

} // namespace test_least_squares
