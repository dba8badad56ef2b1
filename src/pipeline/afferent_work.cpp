// SPDX-License-Identifier: BSD-3-Clause
// The receptors of a case, and their work, memory and file size.
#include "base/units.hpp"
#include "pipeline/afferent_result.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::pipeline {
namespace {

using neural::Scene;

/// Spikes per second of an afferent in the vibrating patch.
constexpr double spikes_per_s = 20.0;

struct Counts {
    double afferents = 0.0, pins = 0.0;
    double samples = 0.0;   // of the motion with its repetitions, silence included
    double seconds = 0.0;   // the same in time
    double counted_s = 0.0; // the part whose spikes count
};

Counts counts_of(const Case& c, const Scene& scene) {
    const AfferentOptions& options = *c.afferents;
    double rate_Hz = 1.0 / c.time.interval_s;
    if (const auto* carrier = std::get_if<CarrierInput>(&options.input))
        rate_Hz = carrier->sampling_Hz;
    const neural::Repetitions repetitions = receptor_repetitions(c, scene);
    const double seconds =
        static_cast<double>(repetitions.total()) * c.time.duration_s() + 2.0 * options.silence_s;
    return {.afferents = static_cast<double>(scene.afferents.size()),
            .pins = static_cast<double>(options.pins_m.size()),
            .samples = seconds * rate_Hz,
            .seconds = seconds,
            .counted_s = static_cast<double>(repetitions.counted) * c.time.duration_s()};
}

} // namespace

std::shared_ptr<const Scene> receptors_of(const Case& c) {
    if (!c.afferents) return {};
    static std::pair<AfferentOptions, std::shared_ptr<const Scene>> latest;
    if (!latest.second || latest.first != *c.afferents)
        latest = {*c.afferents, std::make_shared<const Scene>(neural::make_scene(*c.afferents))};
    return latest.second;
}

double receptors_work(const Case& c, const Scene& scene) {
    const AfferentOptions& options = *c.afferents;
    const Counts n = counts_of(c, scene);
    // Each afferent sums the waves of all pins at each sample, then its neuron is simulated, which
    // takes as long as the waves of 75 pins.
    constexpr double neuron_pins = 75.0;
    return n.afferents * (neuron_pins + (uses_stress(options.input) ? 0.0 : n.pins)) *
           (n.samples + n.seconds * neural::neuron_rate_Hz);
}

double afferents_memory_B(const Case& c, const Scene& scene, int ranks) {
    const Counts n = counts_of(c, scene);
    const bool by_stress = uses_stress(c.afferents->input);
    // The motion of all pins with silence, its load and load rate; or the stress at all receptors,
    // that of a group of receptors with silence, and its rate. In addition, three lines for each of
    // eight afferents at a time, and the transform.
    const double together = std::min(n.afferents / ranks, 64.0); // receptors in a group
    const double lines = by_stress ? 3.0 * together : 4.0 * n.pins;
    const double frames = by_stress ? n.afferents * static_cast<double>(c.time.frames) : 0.0;
    return (frames + (lines + 28.0) * n.samples) * sizeof(double);
}

double afferents_file_B(const Case& c, const Scene& scene) {
    const Counts n = counts_of(c, scene);
    double numbers =
        9.0 * n.afferents + 2.0 * spikes_per_s * n.counted_s * n.afferents + 5.0 * n.pins;
    if (follows_skin(c.afferents->input))
        numbers += (n.pins + 1.0) * n.counted_s / c.time.interval_s;
    return numbers * sizeof(double);
}

} // namespace shearwake::pipeline
