#include "neural/neuron.hpp"
#include "neural/noise.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace shearwake;
using namespace shearwake::neural;

namespace {

/// PC number 1: saturates at 4.9, tau 4.6 samples, cutoff 370 Hz.
EightNeurons pacinian() {
    const std::vector<Afferent> one = {{{}, AfferentClass::PC, 1}};
    return side_by_side(one);
}

Line sine(double frequency_Hz, std::size_t samples) {
    Line line;
    for (std::size_t k = 0; k < samples; ++k)
        line.push_back(all_lanes(std::sin(2.0 * std::numbers::pi * frequency_Hz *
                                          static_cast<double>(k) / neuron_rate_Hz)));
    return line;
}

double largest_of_last(const Line& line, std::size_t count) {
    double largest = 0.0;
    for (std::size_t k = line.size() - count; k < line.size(); ++k)
        largest = std::max(largest, std::abs(line[k][0]));
    return largest;
}

} // namespace

TEST_CASE("the low-pass keeps what is constant, halves the power at 10 low_pass Hz", "[neural]") {
    const EightNeurons neurons = pacinian();
    Line constant(1000, all_lanes(3.0));
    low_pass(neurons, constant);
    CHECK(constant.back()[0] == Approx(3.0).epsilon(1e-12));

    // Settled after 0.2 s; samples hit the crest of an odd frequency to 1e-5 within 0.8 s.
    Line at_cutoff = sine(10.0 * neuron_rows(AfferentClass::PC)[1].low_pass, 5000);
    low_pass(neurons, at_cutoff);
    CHECK(largest_of_last(at_cutoff, 4000) == Approx(std::sqrt(0.5)).epsilon(1e-4));
}

TEST_CASE("the low-pass of third order falls by 18 dB an octave", "[neural]") {
    EightNeurons slow = pacinian();
    slow.low_pass = all_lanes(1.0); // 10 Hz: far below half the rate, where the warping ends it
    const auto gain = [&](double frequency_Hz) {
        Line line = sine(frequency_Hz, 10000);
        low_pass(slow, line);
        return largest_of_last(line, 5000);
    };
    // (f / fc)^-6 over 1 + itself: 1e-3 at ten times fc, and the warping (pi f / f0)^2 of 1.6e-2.
    CHECK(gain(100.1) / gain(200.2) == Approx(8.0).epsilon(0.02));
}

TEST_CASE("positive and negative halves have weights of their own", "[neural]") {
    EightNeurons neurons{};
    neurons.static_positive = all_lanes(2.0);
    neurons.static_negative = all_lanes(3.0);
    neurons.rate_positive = all_lanes(10.0);
    neurons.rate_negative = all_lanes(-20.0);
    neurons.jerk_positive = all_lanes(100.0);
    neurons.jerk_negative = all_lanes(1000.0);
    const Line s = {all_lanes(1.0), all_lanes(-1.0), all_lanes(0.0)};
    const Line d = {all_lanes(0.5), all_lanes(-0.5), all_lanes(1.0)};
    const Line I = current(neurons, s, d);
    CHECK(I[0][0] == 2.0 + 10.0 * 0.5 + 1000.0 * 1.0); // d falls by 1
    CHECK(I[1][3] == 3.0 - 20.0 * 0.5 + 100.0 * 1.5);  // and rises by 1.5
    CHECK(I[2][7] == 10.0);                            // at the end there is no next one
    CHECK(current(neurons, {}, d)[0][0] == I[0][0] - 2.0);
}

TEST_CASE("the saturation bounds the current and leaves small ones", "[neural]") {
    EightNeurons neurons = pacinian();
    Line I = {all_lanes(1e9), all_lanes(-1e9), all_lanes(1e-9)};
    saturate(neurons, I);
    const double bound = neurons.saturation[0];
    CHECK(I[0][0] == Approx(bound).epsilon(1e-8));
    CHECK(I[1][0] == Approx(-bound).epsilon(1e-8));
    CHECK(I[2][0] == Approx(1e-9).epsilon(1e-8));
    neurons.saturation = all_lanes(0.0);
    I = {all_lanes(1e9)};
    saturate(neurons, I);
    CHECK(I[0][0] == 1e9);
}

TEST_CASE("a spike is followed by two currents, the later one highest after 8 ms", "[neural]") {
    EightNeurons neurons{};
    neurons.after_spike_1 = all_lanes(1.0);
    const auto first = after_spike_current(neurons);
    CHECK(first[0][0] == 1.0);
    CHECK(first[16][0] > 0.0);
    CHECK(first[17][0] == 0.0);
    neurons.after_spike_1 = all_lanes(0.0);
    neurons.after_spike_2 = all_lanes(1.0);
    const auto second = after_spike_current(neurons);
    // u = 3 pi/2 where 1 + j/5 = 9.
    CHECK(second[40][0] == Approx(1.0).epsilon(1e-14));
    CHECK(second[39][0] < 1.0);
    CHECK(second[41][0] < 1.0);
    CHECK(second[190][0] == 0.0);
}

TEST_CASE("a leaky membrane reaches its threshold when the exponential does", "[neural]") {
    EightNeurons neurons{};
    neurons.membrane_samples = all_lanes(100.0);
    // V[k] = 100 I (1 - 0.99^(k+1)): with I = 0.02 it passes 1 where 0.99^(k+1) < 1/2, k = 68; then
    // it begins anew.
    const auto spikes = integrate_and_fire(neurons, Line(300, all_lanes(0.02)));
    CHECK(spikes[0] == std::vector<std::uint32_t>{68, 137, 206, 275});
    CHECK(spikes[7] == spikes[0]);
    CHECK(integrate_and_fire(neurons, Line(3000, all_lanes(0.01)))[0].empty()); // 1 is never passed
}

TEST_CASE("two spikes are six samples apart at least, and the first may come at once", "[neural]") {
    EightNeurons neurons{};
    neurons.membrane_samples = all_lanes(1.0);
    const auto spikes = integrate_and_fire(neurons, Line(20, all_lanes(100.0)));
    CHECK(spikes[3] == std::vector<std::uint32_t>{0, 6, 12, 18});
    CHECK(spike_time_s(0) == 0.0002);
}

TEST_CASE("noise is normal, and every sample of every afferent has its own", "[neural]") {
    double mean = 0.0, square = 0.0, next = 0.0, other = 0.0;
    constexpr int pairs = 50000;
    for (int k = 0; k < pairs; ++k) {
        const auto [a, b] = two_normals(42, 3, static_cast<std::uint64_t>(k));
        mean += (a + b) / (2 * pairs);
        square += (a * a + b * b) / (2 * pairs);
        next += a * b / pairs;
        other += a * two_normals(42, 4, static_cast<std::uint64_t>(k))[0] / pairs;
    }
    // Five standard errors of 1e5 and 5e4 draws.
    CHECK(std::abs(mean) < 5.0 * std::sqrt(1e-5));
    CHECK(square == Approx(1.0).margin(5.0 * std::sqrt(2e-5)));
    CHECK(std::abs(next) < 5.0 * std::sqrt(2e-5));
    CHECK(std::abs(other) < 5.0 * std::sqrt(2e-5));
    CHECK(two_normals(42, 3, 9) == two_normals(42, 3, 9));
    CHECK(two_normals(43, 3, 9) != two_normals(42, 3, 9));
}
