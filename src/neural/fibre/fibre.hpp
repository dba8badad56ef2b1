// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/block.hpp"
#include "base/vectors.hpp"
#include "problem/case/afferents.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace shearwake::neural {

using shearwake::AfferentClass;
using shearwake::all_classes;
using shearwake::name_of;

/// Depth of the receptor of this class below the skin surface. Not collective.
double depth_mm(AfferentClass kind);

/// One fibre: the position of its receptor in the skin, its class, and its neuron model.
struct Afferent {
    Vec2 at_mm;
    AfferentClass kind = AfferentClass::PC;
    std::size_t row = 0; // index into neuron_rows(kind)
    bool operator==(const Afferent&) const = default;
};

/// The 13 fitted parameters of one recorded fibre. T is double for one fibre or Block for eight
/// fibres.
template <class T>
struct NeuronParameters {
    T low_pass; // cutoff frequency of the filter divided by 10 Hz
    /// Weights of the positive and negative part of the static stress, 1/MPa.
    T static_positive, static_negative;
    T rate_positive, rate_negative; // weights of the dynamic term, s mm^3/N
    T jerk_positive, jerk_negative; // weights of its first difference
    T saturation;                   // of the current; 0 or less: no saturation
    T noise;                        // standard deviation of the current's noise per sample
    T membrane_samples;             // time constant of the membrane in samples of 0.2 ms
    T after_spike_1, after_spike_2; // weights of the two currents that follow a spike
    T delay_ms;                     // conduction delay along the nerve
};
using NeuronRow = NeuronParameters<double>;

/// The neurons fitted to recordings of this class: 4 SA1, 9 RA, 4 PC.
std::span<const NeuronRow> neuron_rows(AfferentClass kind);

/// Sampling rate at which the neurons are integrated.
inline constexpr double neuron_rate_Hz = 5000.0;

using EightNeurons = NeuronParameters<Block>;
using Line = std::vector<Block>;

/// Parameters of at most eight afferents in the lanes of blocks. Unused lanes repeat the last
/// afferent.
EightNeurons side_by_side(std::span<const Afferent> afferents);

/// Third-order Butterworth low-pass filter with cutoff fc = 10 low_pass [Hz], by the bilinear
/// transform with prewarping, K = tan(pi fc / 5000 Hz):
///     b = K^3 (1, 3, 3, 1) / c,   c = (K + 1)(K^2 + K + 1),
///     a = (K + 1, K - 1) * (K^2 + K + 1, 2 K^2 - 2, K^2 - K + 1) / c   (product of polynomials).
/// Works in place and starts from rest.
void low_pass(const EightNeurons& neurons, Line& line);

/// The current I[k] = w_s+ s+ + w_s- s- + w_r+ d+ + w_r- d- + w_j+ e+ + w_j- e- with the parts v+ =
/// max(v, 0) and v- = max(-v, 0) of the filtered static stress s [MPa], of the filtered dynamic
/// term d [N/(s mm^3)], and of e[k] = d[k+1] - d[k], which is 0 for the last sample. An empty `s`
/// stands for 0.
Line current(const EightNeurons& neurons, const Line& s, Line d);

/// I += noise N(0, 1). The random numbers depend only on the key, the afferent's number and the
/// sample.
void add_noise(const EightNeurons& neurons, std::uint64_t key,
               std::span<const std::uint32_t> afferent_numbers, Line& I);

/// Replaces I by m I / (m + |I|) if the saturation m is positive.
void saturate(const EightNeurons& neurons, Line& I);

/// Number of samples for which a current follows a spike.
inline constexpr std::size_t after_spike_samples = 190;

/// Current after a spike by the number of samples j since the spike:
///     h[j] = after_spike_1 b1[j] + after_spike_2 b2[j],  u = (3 pi/4) ln(1 + j/5) / ln 3,
///     b1 = (1 + cos(min(u, pi))) / 2,   b2 = (1 + cos(clamp(u - 3 pi/2, -pi, pi))) / 2.
/// The additional last entry is 0 and applies to all later samples.
std::array<Block, after_spike_samples + 1> after_spike_current(const EightNeurons& neurons);

/// Leaky integrate-and-fire neurons with V = 0 before the first sample:
///     V += -V/tau + I[k] + h[samples since the last spike].
/// If V > 1 and at least six samples have passed since the last spike, there is a spike, V is set
/// to 0, and h restarts. Returns the sample numbers of the spikes of each lane in ascending order.
std::array<std::vector<std::uint32_t>, lane_count> integrate_and_fire(const EightNeurons& neurons,
                                                                      const Line& I);

/// Time of a spike: the end of its sample. The first sample ends 0.2 ms after the start.
inline double spike_time_s(double sample) {
    return (sample + 1.0) / neuron_rate_Hz;
}

} // namespace shearwake::neural

namespace shearwake::neural {

// Counter-based random numbers, which depend on their arguments alone and therefore neither on the
// rank nor on the order of calls: Philox 4x32-10 of Random123 (Salmon et al., SC 2011). Not
// collective.

/// Two independent standard normal numbers (Box and Muller).
std::array<double, 2> two_normals(std::uint64_t key, std::uint32_t stream, std::uint64_t counter);

/// Two independent uniform numbers in (0, 1).
std::array<double, 2> two_uniforms(std::uint64_t key, std::uint32_t stream, std::uint64_t counter);

} // namespace shearwake::neural
