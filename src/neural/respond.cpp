// SPDX-License-Identifier: BSD-3-Clause
#include "neural/respond.hpp"

#include "neural/kernels/neuron.hpp"
#include "neural/skin/stimulus.hpp"
#include "simd/kernels.hpp"

#include <cmath>
#include <iterator>

namespace shearwake::neural {

namespace {

/// Converts one line per afferent to eight afferents side by side.
Line interleaved(const Lines& lines) {
    Line out(lines.samples);
    for (std::size_t k = 0; k < out.size(); ++k)
        for (std::size_t i = 0; i < lines.count; ++i)
            out[k][static_cast<std::ptrdiff_t>(i)] = lines.values[i * lines.samples + k];
    return out;
}

DelayedLine delayed(std::span<const double> line, std::size_t samples, double gain) {
    return {line.data(), static_cast<std::ptrdiff_t>(samples), gain};
}

void sum_delayed(const std::vector<DelayedLine>& lines, std::span<double> sum) {
    simd::kernels<NeuronKernels>().sum_delayed(lines.data(), std::ssize(lines), std::ssize(sum),
                                               sum.data());
}

} // namespace

PinSource::PinSource(const PinStimulus& stimulus)
    : at_mm_(stimulus.at_mm), radius_mm_(stimulus.radius_mm), rate_Hz_(stimulus.rate_Hz) {
    const Lines loads = loads_N(stimulus);
    rates_N_s_ = load_rates_N_s(loads, rate_Hz_);
    // The stress is a linear combination of the loads. Resampling the loads once is cheaper than
    // resampling the stress at every receptor.
    static_loads_N_ = at_neuron_rate(loads, rate_Hz_);
    samples_ = static_loads_N_.samples;
}

Drive PinSource::drive(std::span<const Afferent> afferents, const SkinPaths& paths) const {
    Lines dynamic(afferents.size(), rates_N_s_.samples), stress(afferents.size(), samples_);
    std::vector<DelayedLine> arriving;
    bool any_static = false;
    for (std::size_t i = 0; i < afferents.size(); ++i) {
        const Afferent& afferent = afferents[i];
        const double z_mm = depth_mm(afferent.kind);
        const std::vector<double> paths_mm = paths(afferent.at_mm);
        arriving.clear();
        for (std::size_t p = 0; p < at_mm_.size(); ++p)
            if (const double gain = wave_gain(paths_mm[p], z_mm, radius_mm_); gain != 0.0)
                arriving.push_back(delayed(
                    rates_N_s_.line(p), arrival_samples(paths_mm[p], radius_mm_, rate_Hz_), gain));
        sum_delayed(arriving, dynamic.line(i));
        if (!properties(afferent.kind).feels_static) continue; // with weight 0
        any_static = true;
        arriving.clear();
        for (std::size_t p = 0; p < at_mm_.size(); ++p)
            arriving.push_back(
                delayed(static_loads_N_.line(p), 0,
                        stress_per_load(norm(afferent.at_mm - at_mm_[p]), z_mm, radius_mm_)));
        sum_delayed(arriving, stress.line(i));
    }
    return {any_static ? interleaved(stress) : Line{},
            interleaved(at_neuron_rate(dynamic, rate_Hz_))};
}

std::array<Spikes, lane_count> fire(std::span<const Afferent> afferents, Drive drive,
                                    const RespondOptions& options, std::uint32_t first_number) {
    const EightNeurons neurons = side_by_side(afferents);
    low_pass(neurons, drive.static_MPa);
    low_pass(neurons, drive.dynamic_N_s_mm3);
    Line I = current(neurons, drive.static_MPa, std::move(drive.dynamic_N_s_mm3));
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
    const SkinPaths paths = options.paths ? options.paths : straight_paths(stimulus.at_mm);
    return each_eight(afferents, options, [&](std::span<const Afferent> eight, std::size_t) {
        return source.drive(eight, paths);
    });
}

namespace {

constexpr double time_constants = 8.0;
constexpr double travel_s = 50e-3; // 400 mm at 8 m/s, twice the length of the hand
constexpr double run_out_s = 10e-3;

/// The number of periods that last at least this time, and at least one.
std::size_t periods_within(double time_s, double period_s) {
    return static_cast<std::size_t>(std::max(std::ceil(time_s / period_s - 1e-9), 1.0));
}

} // namespace

double run_in_s(std::span<const Afferent> afferents) {
    double slowest_samples = 0.0;
    for (const Afferent& one : afferents)
        slowest_samples =
            std::max(slowest_samples, neuron_rows(one.kind)[one.row].membrane_samples);
    const double samples =
        time_constants * slowest_samples + static_cast<double>(after_spike_samples);
    return travel_s + samples / neuron_rate_Hz;
}

Repetitions repetitions_of(std::span<const Afferent> afferents, double period_s,
                           std::size_t counted) {
    return {.run_in = periods_within(run_in_s(afferents), period_s),
            .counted = counted,
            .run_out = periods_within(run_out_s, period_s)};
}

Lines repeated(const Lines& lines, std::size_t times) {
    Lines out(lines.count, times * lines.samples);
    for (std::size_t i = 0; i < lines.count; ++i) {
        auto to = out.line(i).begin();
        for (std::size_t repetition = 0; repetition < times; ++repetition)
            to = std::ranges::copy(lines.line(i), to).out;
    }
    return out;
}

} // namespace shearwake::neural
