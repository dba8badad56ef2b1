#pragma once

#include "base/vec2.hpp"
#include "model/afferents.hpp"

#include <cstddef>
#include <span>

// The mechanoreceptors and their nerve fibres: the forward model of Saal, Delhaye, Rayhaun and
// Bensmaia, PNAS 114 (2017) E5693, doi 10.1073/pnas.1704856114 (TouchSim). Its weights hold numbers
// in mm, N, MPa and N/(s mm^3), so this folder keeps these units and its names say them.

namespace shearwake::neural {

using shearwake::AfferentClass;
using shearwake::all_classes;
using shearwake::name_of;

/// Depth of its receptor below the skin surface.
double depth_mm(AfferentClass kind);

/// One fibre: where it ends in the skin, what it is, and which of the fitted neurons it has.
struct Afferent {
    Vec2 at_mm;
    AfferentClass kind = AfferentClass::PC;
    std::size_t row = 0; // of neuron_rows(kind)
    bool operator==(const Afferent&) const = default;
};

/// The 13 fitted numbers of one recorded fibre; T: of one, or of eight side by side.
template <class T>
struct NeuronParameters {
    T low_pass;                         // cutoff of the filter over 10 Hz
    T static_positive, static_negative; // weights of the halves of the static stress, 1/MPa
    T rate_positive, rate_negative;     // of the dynamic term, s mm^3/N
    T jerk_positive, jerk_negative;     // of its first difference
    T saturation;                       // of the current; none at or below 0
    T noise;                            // standard deviation of the current's noise, a sample
    T membrane_samples;                 // time constant of the membrane in samples of 0.2 ms
    T after_spike_1, after_spike_2;     // weights of the two currents that follow a spike
    T delay_ms;                         // of the conduction along the nerve
};
using NeuronRow = NeuronParameters<double>;

/// The neurons that were fitted to recordings of this class: 4 SA1, 9 RA, 4 PC.
std::span<const NeuronRow> neuron_rows(AfferentClass kind);

/// Samples a second at which the neurons are integrated.
inline constexpr double neuron_rate_Hz = 5000.0;

} // namespace shearwake::neural
