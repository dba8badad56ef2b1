#pragma once

#include "neural/afferent.hpp"
#include "base/lanes.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

// From the stress at a receptor to the spikes of its fibre, in samples of 0.2 ms. A line holds
// eight afferents side by side.

namespace shearwake::neural {

using EightNeurons = NeuronParameters<AlignedLanes>;
using Line = std::vector<AlignedLanes>;

/// The rows of at most eight afferents side by side; lanes beyond them repeat the last one.
EightNeurons side_by_side(std::span<const Afferent> afferents);

/// Third-order Butterworth low-pass at fc = 10 low_pass [Hz], by the bilinear transform with the
/// cutoff in its place, K = tan(pi fc / 5000 Hz):
///     b = K^3 (1, 3, 3, 1) / c,   c = (K + 1)(K^2 + K + 1),
///     a = (K + 1, K - 1) * (K^2 + K + 1, 2 K^2 - 2, K^2 - K + 1) / c   as polynomials.
/// In place; begins at rest.
void low_pass(const EightNeurons& neurons, Line& line);

/// I[k] = w_s+ s+ + w_s- s- + w_r+ d+ + w_r- d- + w_j+ e+ + w_j- e- with the halves v+ = max(v, 0)
/// and v- = max(-v, 0) of the filtered static stress s, of the filtered dynamic term d, and of
/// e[k] = d[k+1] - d[k], which is 0 at the end. Without a static line s is 0.
Line current(const EightNeurons& neurons, const Line& s, const Line& d);

/// I += noise N(0, 1), of random numbers that depend only on the key, the afferent's number and the
/// sample.
void add_noise(const EightNeurons& neurons, std::uint64_t key,
               std::span<const std::uint32_t> afferent_numbers, Line& I);

/// I -> m I / (m + |I|) where the saturation m is above 0.
void saturate(const EightNeurons& neurons, Line& I);

/// Samples for which a spike is followed by a current.
inline constexpr std::size_t after_spike_samples = 190;

/// h[j] = after_spike_1 b1[j] + after_spike_2 b2[j],  u = (3 pi/4) ln(1 + j/5) / ln 3,
///     b1 = (1 + cos(min(u, pi))) / 2,   b2 = (1 + cos(clamp(u - 3 pi/2, -pi, pi))) / 2;
/// one 0 follows at the end: long after a spike there is none.
std::array<AlignedLanes, after_spike_samples + 1> after_spike_current(const EightNeurons& neurons);

/// Leaky integrate-and-fire, V = 0 before the first sample:
///     V += -V/tau + I[k] + h[samples since the last spike];
/// where V > 1 and six samples have gone since the last spike, there is a spike, V = 0 and h begins
/// anew. The samples of the spikes of each lane, ascending.
std::array<std::vector<std::uint32_t>, lane_count> integrate_and_fire(const EightNeurons& neurons,
                                                                      const Line& I);

/// Spike times are those of the sample's end, the first 0.2 ms after the beginning.
inline double spike_time_s(double sample) {
    return (sample + 1.0) / neuron_rate_Hz;
}

} // namespace shearwake::neural
