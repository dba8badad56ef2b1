#include "neural/respond.hpp"

#include "neural/resample.hpp"
#include "neural/skin_stress.hpp"

#include <algorithm>

namespace shearwake::neural {
namespace {

/// From a line an afferent to eight afferents side by side.
Line interleaved(const Lines& lines) {
    Line out(lines.samples);
    for (std::size_t i = 0; i < lines.count; ++i) {
        const auto line = lines.line(i);
        for (std::size_t k = 0; k < out.size(); ++k)
            out[k][i] = line[k];
    }
    return out;
}

} // namespace

PinSource::PinSource(const PinStimulus& stimulus)
    : at_mm_(stimulus.at_mm), radius_mm_(stimulus.radius_mm), rate_Hz_(stimulus.rate_Hz) {
    const Lines loads = loads_N(stimulus);
    rates_N_s_ = load_rates_N_s(loads, rate_Hz_);
    // The stress is a sum of loads: they are resampled once instead of it at every receptor.
    static_loads_N_ = at_neuron_rate(loads, rate_Hz_);
    samples_ = static_loads_N_.samples;
}

Drive PinSource::drive(std::span<const Afferent> afferents, const SkinWays& ways) const {
    Lines dynamic(afferents.size(), rates_N_s_.samples), stress(afferents.size(), samples_);
    bool any_static = false;
    for (std::size_t i = 0; i < afferents.size(); ++i) {
        const Afferent& afferent = afferents[i];
        const double z_mm = depth_mm(afferent.kind);
        const std::vector<double> ways_mm = ways(afferent.at_mm);
        for (std::size_t p = 0; p < at_mm_.size(); ++p) {
            const double way_mm = ways_mm[p];
            add_delayed(rates_N_s_.line(p), arrival_samples(way_mm, radius_mm_, rate_Hz_),
                        wave_gain(way_mm, z_mm, radius_mm_), dynamic.line(i));
        }
        if (afferent.kind != AfferentClass::SA1) continue; // the others weigh it with 0
        any_static = true;
        for (std::size_t p = 0; p < at_mm_.size(); ++p) {
            const double r_mm = norm(afferent.at_mm - at_mm_[p]);
            add_delayed(static_loads_N_.line(p), 0, stress_per_load(r_mm, z_mm, radius_mm_),
                        stress.line(i));
        }
    }
    return {any_static ? interleaved(stress) : Line{},
            interleaved(at_neuron_rate(dynamic, rate_Hz_))};
}

std::array<Spikes, lane_count> fire(std::span<const Afferent> afferents, Drive drive,
                                    const RespondOptions& options, std::uint32_t first_number) {
    const EightNeurons neurons = side_by_side(afferents);
    low_pass(neurons, drive.static_MPa);
    low_pass(neurons, drive.dynamic_N_s_mm3);
    Line I = current(neurons, drive.static_MPa, drive.dynamic_N_s_mm3);
    if (options.noise_key) {
        std::vector<std::uint32_t> numbers;
        for (std::size_t i = 0; i < afferents.size(); ++i)
            numbers.push_back(first_number + static_cast<std::uint32_t>(i));
        add_noise(neurons, *options.noise_key, numbers, I);
    }
    saturate(neurons, I);
    return integrate_and_fire(neurons, I);
}

std::vector<Spikes> respond(const PinStimulus& stimulus, std::span<const Afferent> afferents,
                            const RespondOptions& options) {
    const PinSource source(stimulus);
    const SkinWays ways = options.ways ? options.ways : straight_ways(stimulus.at_mm);
    return each_eight(afferents, options, [&](std::span<const Afferent> eight, std::size_t) {
        return source.drive(eight, ways);
    });
}

} // namespace shearwake::neural
