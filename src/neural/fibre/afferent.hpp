// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "problem/case/afferents.hpp"

#include <cstddef>
#include <span>

// Mechanoreceptors and their nerve fibres: the forward model of Saal, Delhaye, Rayhaun and
// Bensmaia, PNAS 114 (2017) E5693, doi 10.1073/pnas.1704856114 (TouchSim). Its weights are given in
// mm, N, MPa and N/(s mm^3). This folder uses these units and states them in names.

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

} // namespace shearwake::neural
