// SPDX-License-Identifier: BSD-3-Clause
#include "neural/fibre/fibre.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

namespace test_neuron {

using namespace shearwake;
using namespace shearwake::neural;
using shearwake::neural::Line;

/// PC neuron 1: saturation 4.9, time constant 4.6 samples, cutoff 370 Hz.
static EightNeurons pacinian() {
    const std::vector<Afferent> one = {{{}, AfferentClass::PC, 1}};
    return side_by_side(one);
}

static Line sine(double frequency_Hz, std::size_t samples) {
    Line line;
    for (std::size_t k = 0; k < samples; ++k)
        line.push_back(block_of(std::sin(2.0 * std::numbers::pi * frequency_Hz *
                                         static_cast<double>(k) / neuron_rate_Hz)));
    return line;
}

static double largest_of_last(const Line& line, std::size_t count) {
    double largest = 0.0;
    for (std::size_t k = line.size() - count; k < line.size(); ++k)
        largest = std::max(largest, std::abs(line[k][0]));
    return largest;
}

TEST_CASE("low-pass filter preserves constants and halves the power at 10 low_pass Hz",
          "[neural]") {
    const EightNeurons neurons = pacinian();
    Line constant(1000, block_of(3.0));
    low_pass(neurons, constant);
    CHECK(constant.back()[0] == Approx(3.0).epsilon(1e-12));

    // Settled after 0.2 s. Within 0.8 s the samples reach the maximum of this frequency within
    // 1e-5.
    Line at_cutoff = sine(10.0 * neuron_rows(AfferentClass::PC)[1].low_pass, 5000);
    low_pass(neurons, at_cutoff);
    CHECK(largest_of_last(at_cutoff, 4000) == Approx(std::sqrt(0.5)).epsilon(1e-4));
}

TEST_CASE("third-order low-pass filter decreases by 18 dB per octave", "[neural]") {
    EightNeurons slow = pacinian();
    // 10 Hz is far below half of the sampling rate, so that warping is small.
    slow.low_pass = block_of(1.0);
    const auto gain = [&](double frequency_Hz) {
        Line line = sine(frequency_Hz, 10000);
        low_pass(slow, line);
        return largest_of_last(line, 5000);
    };
    // (f / fc)^-6 / (1 + (f / fc)^-6): 1e-3 at ten times fc, and warping (pi f / f0)^2 of 1.6e-2.
    CHECK(gain(100.1) / gain(200.2) == Approx(8.0).epsilon(0.02));
}

TEST_CASE("positive and negative parts have separate weights", "[neural]") {
    EightNeurons neurons{};
    neurons.static_positive = block_of(2.0);
    neurons.static_negative = block_of(3.0);
    neurons.rate_positive = block_of(10.0);
    neurons.rate_negative = block_of(-20.0);
    neurons.jerk_positive = block_of(100.0);
    neurons.jerk_negative = block_of(1000.0);
    const Line s = {block_of(1.0), block_of(-1.0), block_of(0.0)};
    const Line d = {block_of(0.5), block_of(-0.5), block_of(1.0)};
    const Line I = current(neurons, s, d);
    CHECK(I[0][0] == 2.0 + 10.0 * 0.5 + 1000.0 * 1.0); // d decreases by 1
    CHECK(I[1][3] == 3.0 - 20.0 * 0.5 + 100.0 * 1.5);  // d increases by 1.5
    CHECK(I[2][7] == 10.0);                            // the last sample has no successor
    CHECK(current(neurons, {}, d)[0][0] == I[0][0] - 2.0);
}

TEST_CASE("saturation limits large currents and preserves small ones", "[neural]") {
    EightNeurons neurons = pacinian();
    Line I = {block_of(1e9), block_of(-1e9), block_of(1e-9)};
    saturate(neurons, I);
    const double bound = neurons.saturation[0];
    CHECK(I[0][0] == Approx(bound).epsilon(1e-8));
    CHECK(I[1][0] == Approx(-bound).epsilon(1e-8));
    CHECK(I[2][0] == Approx(1e-9).epsilon(1e-8));
    neurons.saturation = block_of(0.0);
    I = {block_of(1e9)};
    saturate(neurons, I);
    CHECK(I[0][0] == 1e9);
}

TEST_CASE("two currents follow a spike and the second one peaks after 8 ms", "[neural]") {
    EightNeurons neurons{};
    neurons.after_spike_1 = block_of(1.0);
    const auto first = after_spike_current(neurons);
    CHECK(first[0][0] == 1.0);
    CHECK(first[16][0] > 0.0);
    CHECK(first[17][0] == 0.0);
    neurons.after_spike_1 = block_of(0.0);
    neurons.after_spike_2 = block_of(1.0);
    const auto second = after_spike_current(neurons);
    // u = 3 pi/2 where 1 + j/5 = 9.
    CHECK(second[40][0] == Approx(1.0).epsilon(1e-14));
    CHECK(second[39][0] < 1.0);
    CHECK(second[41][0] < 1.0);
    CHECK(second[190][0] == 0.0);
}

TEST_CASE("leaky membrane reaches its threshold at the time of the closed form", "[neural]") {
    EightNeurons neurons{};
    neurons.membrane_samples = block_of(100.0);
    // V[k] = 100 I (1 - 0.99^(k+1)): with I = 0.02 it exceeds 1 where 0.99^(k+1) < 1/2, at k = 68,
    // and is then reset.
    const auto spikes = integrate_and_fire(neurons, Line(300, block_of(0.02)));
    CHECK(spikes[0] == std::vector<std::uint32_t>{68, 137, 206, 275});
    CHECK(spikes[7] == spikes[0]);
    CHECK(integrate_and_fire(neurons, Line(3000, block_of(0.01)))[0].empty()); // never exceeds 1
}

TEST_CASE("spikes are at least six samples apart and the first one may be immediate", "[neural]") {
    EightNeurons neurons{};
    neurons.membrane_samples = block_of(1.0);
    const auto spikes = integrate_and_fire(neurons, Line(20, block_of(100.0)));
    CHECK(spikes[3] == std::vector<std::uint32_t>{0, 6, 12, 18});
    CHECK(spike_time_s(0) == 0.0002);
}

TEST_CASE("noise is normal and independent for each sample and afferent", "[neural]") {
    double mean = 0.0, square = 0.0, next = 0.0, other = 0.0;
    constexpr int pairs = 50000;
    for (int k = 0; k < pairs; ++k) {
        const auto [a, b] = two_normals(42, 3, static_cast<std::uint64_t>(k));
        mean += (a + b) / (2 * pairs);
        square += (a * a + b * b) / (2 * pairs);
        next += a * b / pairs;
        other += a * two_normals(42, 4, static_cast<std::uint64_t>(k))[0] / pairs;
    }
    // Limits of five standard errors for 1e5 and 5e4 samples.
    CHECK(std::abs(mean) < 5.0 * std::sqrt(1e-5));
    CHECK(square == Approx(1.0).margin(5.0 * std::sqrt(2e-5)));
    CHECK(std::abs(next) < 5.0 * std::sqrt(2e-5));
    CHECK(std::abs(other) < 5.0 * std::sqrt(2e-5));
    CHECK(two_normals(42, 3, 9) == two_normals(42, 3, 9));
    CHECK(two_normals(43, 3, 9) != two_normals(42, 3, 9));
}

} // namespace test_neuron
