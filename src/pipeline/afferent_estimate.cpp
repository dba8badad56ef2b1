// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/afferent_estimate.hpp"

#include "neural/fibre/neuron.hpp"
#include "neural/hand/scene.hpp"
#include "pipeline/afferent_result.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::pipeline {
namespace {

// Seconds on a core of 2020.
constexpr engines::WorkKind of_scene = {"receptors.hand",
                                        5e-4}; // per case: outlines, positions of fibres
constexpr engines::WorkKind of_way = {"receptors.way",
                                      2e-6}; // per pin and afferent, within the hand
constexpr engines::WorkKind of_neuron = {"receptors.neuron",
                                         3e-9}; // per afferent and sample of 0.2 ms
constexpr engines::WorkKind of_noise = {"receptors.noise", 10e-9}; // the same
constexpr engines::WorkKind of_wave = {"receptors.wave", 1e-9};    // per pin, afferent and sample
constexpr engines::WorkKind of_sampling = {"receptors.sampling", 5e-9}; // per line and sample
/// Spikes per second of an afferent in the vibrating patch.
constexpr double spikes_per_s = 20.0;

struct Counts {
    double afferents = 0.0, pins = 0.0;
    double samples = 0.0;   // of the motion with its repetitions, silence included
    double seconds = 0.0;   // the same in time
    double counted_s = 0.0; // the part whose spikes count
};

Counts counts_of(const Case& c) {
    const AfferentOptions& options = *c.afferents;
    double rate_Hz = 1.0 / c.time.interval_s;
    if (const auto* carrier = std::get_if<CarrierInput>(&options.input))
        rate_Hz = carrier->sampling_Hz;
    const neural::Repetitions repetitions = receptor_repetitions(c);
    const double seconds =
        static_cast<double>(repetitions.total()) * c.time.duration_s() + 2.0 * options.silence_s;
    return {.afferents = static_cast<double>(neural::make_scene(options).afferents.size()),
            .pins = static_cast<double>(options.pins_m.size()),
            .samples = seconds * rate_Hz,
            .seconds = seconds,
            .counted_s = static_cast<double>(repetitions.counted) * c.time.duration_s()};
}

/// Number of frames of a field with negligible computing time.
Case calibration_case(AfferentInput input) {
    Case c;
    c.scene().medium = {{{.name = "tissue",
                          .density_kg_m3 = 1000.0,
                          .c_p_m_s = 1500.0,
                          .c_s_m_s = 5.0,
                          .loss = KelvinVoigt{1.0}}},
                        Base::half_space};
    c.scene().load.peak_Pa = 100.0;
    c.scene().load.footprint = GaussianFootprint{2e-2};
    c.scene().load.modulation = {
        .kind = "AM", .trajectory = {{Hold{}}}, .envelope = {{SineGain{.frequency_Hz = 200.0}}}};
    c.domain = {16, 12, 8e-3, 0.0};
    c.time = {100, 200e-6};
    c.measure = {.at_s = c.time.duration_s(), .settled_after_s = 0.0, .focal_radius_m = 2e-2};
    c.afferents = AfferentOptions{.places = GridAfferents{{3e-2, 2e-2}, 1e-3}, .input = input};
    return c;
}

} // namespace

std::vector<engines::Work> receptors_work(const Case& c) {
    if (!c.afferents) return {};
    const AfferentOptions& options = *c.afferents;
    const Counts n = counts_of(c);
    const double fired = 8.0 * std::ceil(n.afferents / 8.0) * n.seconds * neural::neuron_rate_Hz;
    std::vector<engines::Work> work = {{of_scene, 1.0}, {of_neuron, fired}};
    if (options.noise == Switch::on) work.push_back({of_noise, fired});
    const bool by_stress = std::holds_alternative<StressInput>(options.input);
    work.push_back({of_sampling, (n.afferents + (by_stress ? 0.0 : n.pins)) * n.samples});
    if (by_stress) return work;
    work.push_back({of_wave, n.pins * n.afferents * n.samples});
    if (options.sheet == SkinSheet::hand) work.push_back({of_way, n.pins * n.afferents});
    return work;
}

std::vector<engines::Calibration> receptor_calibrations() {
    Case scene = calibration_case(StressInput{});
    scene.time.frames = 20;
    scene.afferents->places = AfferentList{{{{}, AfferentClass::PC, 0}}};
    Case neuron = calibration_case(CarrierInput{.frequency_Hz = 300.0, .sampling_Hz = 5000.0});
    neuron.time.frames = 600;
    neuron.afferents->sheet = SkinSheet::flat;
    Case noise = neuron;
    noise.afferents->noise = Switch::on;
    Case wave = neuron;
    wave.time.frames = 200;
    wave.afferents->places = GridAfferents{{3e-2, 2e-2}, 2e-3};
    for (int i = 0; i < 40; ++i)
        wave.afferents->pins_m.push_back({1e-4 * (i + 1), 0.0});
    Case sampling = calibration_case(CarrierInput{.frequency_Hz = 4e4, .sampling_Hz = 2e5});
    sampling.afferents->sheet = SkinSheet::flat;
    sampling.afferents->places = GridAfferents{{1e-2, 1e-2}, 1e-3};
    Case way = wave;
    way.time.frames = 10;
    way.afferents->sheet = SkinSheet::hand;
    for (Case* c : {&scene, &neuron, &noise, &wave, &sampling, &way})
        c->measure.at_s = c->time.duration_s();
    return {{of_scene.name, scene}, {of_neuron.name, neuron},     {of_noise.name, noise},
            {of_wave.name, wave},   {of_sampling.name, sampling}, {of_way.name, way}};
}

double afferents_memory_B(const Case& c, int ranks) {
    if (!c.afferents) return 0.0;
    const Counts n = counts_of(c);
    const bool by_stress = std::holds_alternative<StressInput>(c.afferents->input);
    // The motion of all pins with silence, its load and load rate; or the stress at all receptors,
    // that of a group of receptors with silence, and its rate. In addition, three lines for each of
    // eight afferents at a time, and the transform.
    const double together = std::min(n.afferents / ranks, 64.0); // receptors in a group
    const double lines = by_stress ? 3.0 * together : 4.0 * n.pins;
    const double frames = by_stress ? n.afferents * static_cast<double>(c.time.frames) : 0.0;
    return (frames + (lines + 28.0) * n.samples) * sizeof(double);
}

double afferents_file_B(const Case& c) {
    if (!c.afferents) return 0.0;
    const Counts n = counts_of(c);
    double numbers =
        9.0 * n.afferents + 2.0 * spikes_per_s * n.counted_s * n.afferents + 5.0 * n.pins;
    if (std::holds_alternative<PinInput>(c.afferents->input))
        numbers += (n.pins + 1.0) * n.counted_s / c.time.interval_s;
    return numbers * sizeof(double);
}

} // namespace shearwake::pipeline
