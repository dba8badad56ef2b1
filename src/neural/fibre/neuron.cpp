// SPDX-License-Identifier: BSD-3-Clause
#include "neural/fibre/neuron.hpp"

#include "base/units.hpp"
#include "neural/kernels/neuron.hpp"
#include "simd/kernels.hpp"

#include <Random123/philox.h>
#include <Random123/uniform.hpp>
#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <numbers>

namespace shearwake::neural {

namespace {

const NeuronKernels& kernels() {
    return simd::kernels<NeuronKernels>();
}

LowPass low_pass_of(const EightNeurons& neurons) {
    LowPass filter;
    for (std::ptrdiff_t i = 0; i < lane_count; ++i) {
        const double K = std::tan(std::numbers::pi * 10.0 / neuron_rate_Hz * neurons.low_pass[i]);
        const double p0 = K + 1.0, p1 = K - 1.0; // first-order factor
        // Second-order factor.
        const double q0 = K * K + K + 1.0, q1 = 2.0 * K * K - 2.0, q2 = K * K - K + 1.0;
        const double c = p0 * q0;
        filter.b[i] = K * K * K / c;
        filter.a1[i] = (p0 * q1 + p1 * q0) / c;
        filter.a2[i] = (p0 * q2 + p1 * q1) / c;
        filter.a3[i] = p1 * q2 / c;
    }
    return filter;
}

} // namespace

EightNeurons side_by_side(std::span<const Afferent> afferents) {
    using Row = NeuronRow;
    constexpr std::array<std::pair<double Row::*, Block EightNeurons::*>, 13> members = {
        {{&Row::low_pass, &EightNeurons::low_pass},
         {&Row::static_positive, &EightNeurons::static_positive},
         {&Row::static_negative, &EightNeurons::static_negative},
         {&Row::rate_positive, &EightNeurons::rate_positive},
         {&Row::rate_negative, &EightNeurons::rate_negative},
         {&Row::jerk_positive, &EightNeurons::jerk_positive},
         {&Row::jerk_negative, &EightNeurons::jerk_negative},
         {&Row::saturation, &EightNeurons::saturation},
         {&Row::noise, &EightNeurons::noise},
         {&Row::membrane_samples, &EightNeurons::membrane_samples},
         {&Row::after_spike_1, &EightNeurons::after_spike_1},
         {&Row::after_spike_2, &EightNeurons::after_spike_2},
         {&Row::delay_ms, &EightNeurons::delay_ms}}};
    EightNeurons eight{};
    for (std::ptrdiff_t i = 0; i < lane_count; ++i) {
        const Afferent& afferent =
            afferents[std::min(static_cast<std::size_t>(i), afferents.size() - 1)];
        const NeuronRow& row = neuron_rows(afferent.kind)[afferent.row];
        for (const auto& [one, lanes] : members)
            (eight.*lanes)[i] = row.*one;
    }
    return eight;
}

void low_pass(const EightNeurons& neurons, Line& line) {
    kernels().low_pass(low_pass_of(neurons), std::ssize(line), line.data());
}

Line current(const EightNeurons& neurons, const Line& s, Line d) {
    const CurrentWeights weights = {.static_positive = neurons.static_positive,
                                    .static_negative = neurons.static_negative,
                                    .rate_positive = neurons.rate_positive,
                                    .rate_negative = neurons.rate_negative,
                                    .jerk_positive = neurons.jerk_positive,
                                    .jerk_negative = neurons.jerk_negative};
    kernels().current(weights, std::ssize(d), s.empty() ? nullptr : s.data(), d.data());
    return d;
}

void add_noise(const EightNeurons& neurons, std::uint64_t key,
               std::span<const std::uint32_t> afferent_numbers, Line& I) {
    for (std::size_t k = 0; k < I.size(); k += 2) {
        for (std::size_t i = 0; i < afferent_numbers.size(); ++i) {
            const auto lane = static_cast<std::ptrdiff_t>(i);
            const auto pair = two_normals(key, afferent_numbers[i], k / 2);
            I[k][lane] += neurons.noise[lane] * pair[0];
            if (k + 1 < I.size()) I[k + 1][lane] += neurons.noise[lane] * pair[1];
        }
    }
}

void saturate(const EightNeurons& neurons, Line& I) {
    kernels().saturate(neurons.saturation, std::ssize(I), I.data());
}

std::array<Block, after_spike_samples + 1> after_spike_current(const EightNeurons& neurons) {
    using std::numbers::pi;
    std::array<Block, after_spike_samples + 1> h{};
    for (std::size_t j = 0; j < after_spike_samples; ++j) {
        const double u = 0.75 * pi * std::log1p(static_cast<double>(j) / 5.0) / std::log(3.0);
        const double b1 = 0.5 * (1.0 + std::cos(std::min(u, pi)));
        const double b2 = 0.5 * (1.0 + std::cos(std::clamp(u - 1.5 * pi, -pi, pi)));
        add_scaled(b1, neurons.after_spike_1, h[j]);
        add_scaled(b2, neurons.after_spike_2, h[j]);
    }
    return h;
}

std::array<std::vector<std::uint32_t>, lane_count> integrate_and_fire(const EightNeurons& neurons,
                                                                      const Line& I) {
    const auto h = after_spike_current(neurons);
    std::vector<unsigned char> fired(I.size());
    kernels().integrate_and_fire(neurons.membrane_samples, h.data(), after_spike_samples,
                                 std::ssize(I), I.data(), fired.data());
    std::array<std::vector<std::uint32_t>, lane_count> spikes;
    for (std::size_t k = 0; k < fired.size(); ++k)
        for (unsigned lanes = fired[k]; lanes != 0; lanes &= lanes - 1)
            spikes[static_cast<std::size_t>(std::countr_zero(lanes))].push_back(
                static_cast<std::uint32_t>(k));
    return spikes;
}

std::array<double, 2> two_uniforms(std::uint64_t key, std::uint32_t stream, std::uint64_t counter) {
    const auto low = [](std::uint64_t v) { return static_cast<std::uint32_t>(v); };
    const r123::Philox4x32::ctr_type at = {{low(counter), low(counter >> 32), stream, 0}};
    const r123::Philox4x32::key_type with = {{low(key), low(key >> 32)}};
    const auto bits = r123::Philox4x32{}(at, with);
    const auto word = [&](std::size_t i) {
        return static_cast<std::uint64_t>(bits[i + 1]) << 32 | bits[i];
    };
    return {r123::u01<double>(word(0)), r123::u01<double>(word(2))};
}

std::array<double, 2> two_normals(std::uint64_t key, std::uint32_t stream, std::uint64_t counter) {
    const auto [u, v] = two_uniforms(key, stream, counter);
    const double radius = std::sqrt(-2.0 * std::log(u)), angle = two_pi * v;
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

} // namespace shearwake::neural
