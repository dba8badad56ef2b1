// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/stimulus.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

namespace test_resample {

using namespace shearwake::neural;

constexpr double rounding = 1e-12; // of a transform of a few thousand points

static std::vector<double> wave(std::size_t samples, double periods, double phase) {
    std::vector<double> line(samples);
    for (std::size_t k = 0; k < samples; ++k)
        line[k] = std::cos(2.0 * std::numbers::pi * periods * static_cast<double>(k) /
                               static_cast<double>(samples) +
                           phase);
    return line;
}

static double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t k = 0; k < b.size(); ++k)
        largest = std::max(largest, std::abs(a.at(k) - b[k]));
    return largest;
}

static std::vector<double> resampled(const std::vector<double>& line, std::size_t to) {
    std::vector<double> out(to);
    FourierResampler(line.size(), to)(line, out);
    return out;
}

TEST_CASE("resampling is exact for complete periods below both Nyquist frequencies", "[neural]") {
    const std::size_t from = GENERATE(1000u, 999u, 4000u), to = GENERATE(500u, 501u, 1000u, 1250u);
    const double periods = GENERATE(0.0, 1.0, 37.0, 249.0);
    CHECK(largest_difference(resampled(wave(from, periods, 0.7), to), wave(to, periods, 0.7)) <
          rounding);
}

TEST_CASE("resampling removes frequencies above the new Nyquist frequency", "[neural]") {
    CHECK(largest_difference(resampled(wave(4000, 800.0, 0.7), 500), std::vector<double>(500)) <
          rounding);
}

TEST_CASE("resampling preserves a cosine at the lower Nyquist frequency", "[neural]") {
    // At the new limit the cosine occurs at both ends of the spectrum, which are added.
    CHECK(largest_difference(resampled(wave(400, 50.0, 0.0), 100), wave(100, 50.0, 0.0)) <
          rounding);
    // When upsampling, the value is divided between both ends, so that it stays a cosine.
    CHECK(largest_difference(resampled(wave(100, 50.0, 0.0), 400), wave(400, 50.0, 0.0)) <
          rounding);
}

TEST_CASE("resampling two lines together equals resampling each alone", "[neural]") {
    const auto a = wave(1000, 3.3, 0.1), b = wave(1000, 17.9, 1.0);
    std::vector<double> a_both(250), b_both(250);
    FourierResampler(1000, 250)(a, b, a_both, b_both);
    CHECK(largest_difference(a_both, resampled(a, 250)) < rounding);
    CHECK(largest_difference(b_both, resampled(b, 250)) < rounding);
}

TEST_CASE("length of a resampled line is rounded to the nearest with ties to even", "[neural]") {
    CHECK(resampled_length(10000, 20000.0) == 2500);
    CHECK(resampled_length(1001, 10000.0) == 500); // 500.5
    CHECK(resampled_length(1003, 10000.0) == 502); // 501.5
    CHECK(is_neuron_rate(5000.0 * (1.0 + 1e-10)));
    CHECK_FALSE(is_neuron_rate(5000.1));
}

} // namespace test_resample
