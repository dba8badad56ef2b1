#include "neural/neuron.hpp"

#include "neural/noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::neural {
namespace {

AlignedLanes tangent(AlignedLanes v) {
    for (std::size_t i = 0; i < lane_count; ++i)
        v[i] = std::tan(v[i]);
    return v;
}

} // namespace

EightNeurons side_by_side(std::span<const Afferent> afferents) {
    using Row = NeuronRow;
    constexpr std::array<std::pair<double Row::*, AlignedLanes EightNeurons::*>, 13> members = {
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
    for (std::size_t i = 0; i < lane_count; ++i) {
        const Afferent& afferent = afferents[std::min(i, afferents.size() - 1)];
        const NeuronRow& row = neuron_rows(afferent.kind)[afferent.row];
        for (const auto& [one, lanes] : members)
            (eight.*lanes)[i] = row.*one;
    }
    return eight;
}

void low_pass(const EightNeurons& neurons, Line& line) {
    const AlignedLanes K = tangent(std::numbers::pi * 10.0 / neuron_rate_Hz * neurons.low_pass);
    const AlignedLanes p0 = K + 1.0, p1 = K - 1.0; // first order
    const AlignedLanes q0 = K * K + K + 1.0, q1 = 2.0 * K * K - 2.0, q2 = K * K - K + 1.0; // second
    const AlignedLanes c = p0 * q0;
    const AlignedLanes b = K * K * K / c;
    const AlignedLanes a1 = (p0 * q1 + p1 * q0) / c, a2 = (p0 * q2 + p1 * q1) / c, a3 = p1 * q2 / c;
    AlignedLanes state1{}, state2{}, state3{}; // transposed direct form II
    for (AlignedLanes& value : line) {
        const AlignedLanes in = b * value;
        const AlignedLanes out = in + state1;
        state1 = 3.0 * in - a1 * out + state2;
        state2 = 3.0 * in - a2 * out + state3;
        state3 = in - a3 * out;
        value = out;
    }
}

Line current(const EightNeurons& neurons, const Line& s, const Line& d) {
    Line I(d.size());
    for (std::size_t k = 0; k < d.size(); ++k) {
        const AlignedLanes e = k + 1 < d.size() ? d[k + 1] - d[k] : AlignedLanes{};
        I[k] = neurons.rate_positive * positive_part(d[k]) +
               neurons.rate_negative * negative_part(d[k]) +
               neurons.jerk_positive * positive_part(e) + neurons.jerk_negative * negative_part(e);
        if (!s.empty())
            I[k] += neurons.static_positive * positive_part(s[k]) +
                    neurons.static_negative * negative_part(s[k]);
    }
    return I;
}

void add_noise(const EightNeurons& neurons, std::uint64_t key,
               std::span<const std::uint32_t> afferent_numbers, Line& I) {
    for (std::size_t k = 0; k < I.size(); k += 2) {
        AlignedLanes even{}, odd{};
        for (std::size_t i = 0; i < afferent_numbers.size(); ++i) {
            const auto pair = two_normals(key, afferent_numbers[i], k / 2);
            even[i] = pair[0];
            odd[i] = pair[1];
        }
        I[k] += neurons.noise * even;
        if (k + 1 < I.size()) I[k + 1] += neurons.noise * odd;
    }
}

void saturate(const EightNeurons& neurons, Line& I) {
    const AlignedLanes m = neurons.saturation;
    for (AlignedLanes& value : I)
        value = m > 0.0 ? m * value / (m + magnitude(value)) : value;
}

std::array<AlignedLanes, after_spike_samples + 1> after_spike_current(const EightNeurons& neurons) {
    using std::numbers::pi;
    std::array<AlignedLanes, after_spike_samples + 1> h{};
    for (std::size_t j = 0; j < after_spike_samples; ++j) {
        const double u = 0.75 * pi * std::log1p(static_cast<double>(j) / 5.0) / std::log(3.0);
        const double b1 = 0.5 * (1.0 + std::cos(std::min(u, pi)));
        const double b2 = 0.5 * (1.0 + std::cos(std::clamp(u - 1.5 * pi, -pi, pi)));
        h[j] = neurons.after_spike_1 * b1 + neurons.after_spike_2 * b2;
    }
    return h;
}

std::array<std::vector<std::uint32_t>, lane_count> integrate_and_fire(const EightNeurons& neurons,
                                                                      const Line& I) {
    constexpr std::size_t shortest_interval = 6;
    const auto h = after_spike_current(neurons);
    std::array<std::vector<std::uint32_t>, lane_count> spikes;
    std::array<std::size_t, lane_count> since; // the last spike, in samples
    since.fill(after_spike_samples);
    AlignedLanes V{};
    for (std::size_t k = 0; k < I.size(); ++k) {
        AlignedLanes after{};
        for (std::size_t i = 0; i < lane_count; ++i) {
            after[i] = h[since[i]][i];
            since[i] = std::min(since[i] + 1, after_spike_samples);
        }
        V += -V / neurons.membrane_samples + I[k] + after;
        for (std::size_t i = 0; i < lane_count; ++i)
            if (V[i] > 1.0 && since[i] >= shortest_interval) {
                spikes[i].push_back(static_cast<std::uint32_t>(k));
                V[i] = 0.0;
                since[i] = 0;
            }
    }
    return spikes;
}

} // namespace shearwake::neural
