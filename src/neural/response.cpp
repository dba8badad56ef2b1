// SPDX-License-Identifier: BSD-3-Clause
#include "neural/response.hpp"

#include "base/units.hpp"
#include "neural/skin/stimulus.hpp"
#include "neural/skin/skin.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace shearwake::neural {

double dynamic_per_stress_rate(double depth_mm, double radius_mm) {
    return wave_gain(0.0, depth_mm, radius_mm) / stress_per_load(0.0, depth_mm, radius_mm);
}

StressSource::StressSource(Lines compression_MPa, double rate_Hz, double radius_mm)
    : radius_mm_(radius_mm),
      rates_MPa_s_(at_neuron_rate(load_rates_N_s(compression_MPa, rate_Hz), rate_Hz)) {
    stress_MPa_ = at_neuron_rate(compression_MPa, rate_Hz);
}

Drive StressSource::drive(std::span<const Afferent> afferents, std::size_t first) const {
    Drive drive{{}, Line(samples())};
    for (std::size_t i = 0; i < afferents.size(); ++i) {
        const double scale = dynamic_per_stress_rate(depth_mm(afferents[i].kind), radius_mm_);
        const auto rate = rates_MPa_s_.line(first + i);
        for (std::size_t k = 0; k < samples(); ++k)
            drive.dynamic_N_s_mm3[k][static_cast<std::ptrdiff_t>(i)] = scale * rate[k];
        if (!properties(afferents[i].kind).feels_static) continue;
        drive.static_MPa.resize(samples());
        const auto stress = stress_MPa_.line(first + i);
        for (std::size_t k = 0; k < samples(); ++k)
            drive.static_MPa[k][static_cast<std::ptrdiff_t>(i)] = stress[k];
    }
    return drive;
}

std::vector<Spikes> respond(const StressSource& source, std::span<const Afferent> afferents,
                            const RespondOptions& options) {
    return each_eight(afferents, options, [&](std::span<const Afferent> eight, std::size_t first) {
        return source.drive(eight, first);
    });
}

namespace {

/// |sum exp(2 pi i f t)|
double resultant(const std::vector<double>& times_s, double frequency_Hz) {
    std::complex<double> sum = 0.0;
    for (const double t_s : times_s)
        sum += std::polar(1.0, two_pi * std::fmod(frequency_Hz * t_s, 1.0));
    return std::abs(sum);
}

RespondOptions options_of(const AfferentOptions& options, std::size_t first, std::uint64_t key) {
    RespondOptions how{.noise_key = std::nullopt,
                       .first_number = static_cast<std::uint32_t>(first)};
    if (options.noise == Switch::on) how.noise_key = key;
    return how;
}

/// Times of the spikes within the counted part of the stimulus, which begins `before_s` after the
/// first sample.
SpikeTimes times_of(const std::vector<Spikes>& spikes, std::span<const Afferent> afferents,
                    double before_s, const CountedTime& counted, Switch conduction_delay) {
    constexpr double slack_s = 1e-9; // tolerance for rounding errors
    SpikeTimes times_s(spikes.size());
    for (std::size_t i = 0; i < spikes.size(); ++i) {
        const NeuronRow& row = neuron_rows(afferents[i].kind)[afferents[i].row];
        const double delay_s = conduction_delay == Switch::on ? 1e-3 * row.delay_ms : 0.0;
        for (const std::uint32_t sample : spikes[i]) {
            const double t_s = spike_time_s(sample) - before_s - counted.from_s;
            if (t_s > slack_s && t_s < counted.to_s - counted.from_s + slack_s)
                times_s[i].push_back(t_s + delay_s);
        }
    }
    return times_s;
}

/// The largest number of spikes in a window, divided by its duration.
double peak_rate_Hz(std::vector<double> times_s) {
    std::ranges::sort(times_s);
    std::size_t most = 0;
    for (std::size_t first = 0, end = 0; first < times_s.size(); ++first) {
        while (end < times_s.size() && times_s[end] < times_s[first] + peak_window_s)
            ++end;
        most = std::max(most, end - first);
    }
    return static_cast<double>(most) / peak_window_s;
}

/// The counted time, up to the end of a stimulus.
CountedTime limited(CountedTime counted, std::size_t samples, double rate_Hz) {
    counted.to_s = std::min(counted.to_s, static_cast<double>(samples) / rate_Hz);
    return counted;
}

} // namespace

SpikeTimes response_to_pins(const PinStimulus& stimulus, const Scene& scene, std::size_t first,
                            std::size_t count, const AfferentOptions& options, std::uint64_t key,
                            const CountedTime& counted) {
    SilencedLines silenced =
        with_silence(stimulus.indentation_mm, stimulus.rate_Hz, options.silence_s);
    const PinStimulus pins{.at_mm = stimulus.at_mm,
                           .radius_mm = fitting_radius_mm(stimulus.at_mm, stimulus.radius_mm),
                           .rate_Hz = stimulus.rate_Hz,
                           .indentation_mm = std::move(silenced.lines)};
    const auto afferents = std::span(scene.afferents).subspan(first, count);
    RespondOptions how = options_of(options, first, key);
    how.paths = scene.skin_mm.empty() ? straight_paths(stimulus.at_mm)
                                      : paths_within(scene.skin_mm, stimulus.at_mm);
    return times_of(respond(pins, afferents, how), afferents, silenced.before_s,
                    limited(counted, stimulus.indentation_mm.samples, stimulus.rate_Hz),
                    options.conduction_delay);
}

SpikeTimes response_to_stress(const Lines& compression_MPa, double rate_Hz, double radius_mm,
                              const Scene& scene, std::size_t first, std::size_t count,
                              const AfferentOptions& options, std::uint64_t key,
                              const CountedTime& counted) {
    SilencedLines silenced = with_silence(compression_MPa, rate_Hz, options.silence_s);
    const auto afferents = std::span(scene.afferents).subspan(first, count);
    const StressSource source(std::move(silenced.lines), rate_Hz, radius_mm);
    return times_of(respond(source, afferents, options_of(options, first, key)), afferents,
                    silenced.before_s, limited(counted, compression_MPa.samples, rate_Hz),
                    options.conduction_delay);
}

std::vector<ClassResponse> class_responses(std::span<const Afferent> afferents,
                                           const SpikeTimes& times_s, double duration_s,
                                           double frequency_Hz, double near_mm,
                                           const std::function<double(Vec2)>& distance_mm) {
    std::vector<ClassResponse> responses;
    for (const AfferentClass kind : all_classes) {
        ClassResponse r{.kind = kind};
        double squares = 0.0, in_phase = 0.0, pairs = 0.0, first_s = not_a_number;
        double together = 0.0, of_spikes = 0.0, near = 0.0;
        std::vector<double> all_s;
        for (std::size_t i = 0; i < afferents.size(); ++i) {
            if (afferents[i].kind != kind) continue;
            ++r.afferents;
            const std::vector<double>& train = times_s[i];
            if (train.empty()) continue;
            ++r.active;
            r.spikes += train.size();
            const auto n = static_cast<double>(train.size());
            const double from_path_mm = distance_mm(afferents[i].at_mm);
            squares += n * std::pow(from_path_mm, 2);
            if (from_path_mm <= near_mm) near += n;
            all_s.insert(all_s.end(), train.begin(), train.end());
            first_s = std::isnan(first_s) ? train.front() : std::min(first_s, train.front());
            r.most_spikes = std::max(r.most_spikes, train.size());
            if (train.size() < 2 || !(frequency_Hz > 0.0)) continue;
            const double sum = resultant(train, frequency_Hz);
            together += sum;
            of_spikes += n;
            if (train.size() < fewest_for_locking) continue;
            in_phase += sum * sum - n;
            pairs += n * (n - 1.0);
        }
        if (r.afferents == 0) continue;
        const auto n = static_cast<double>(r.spikes);
        r.mean_rate_Hz =
            r.active > 0 ? n / duration_s / static_cast<double>(r.active) : not_a_number;
        r.total_rate_Hz = n / duration_s;
        r.peak_rate_Hz =
            duration_s >= peak_window_s ? peak_rate_Hz(std::move(all_s)) : not_a_number;
        r.near_share = r.spikes > 0 ? near / n : not_a_number;
        r.spread_mm = r.spikes > 0 ? std::sqrt(squares / n) : not_a_number;
        r.vector_strength = of_spikes > 0.0 ? together / of_spikes : not_a_number;
        r.locking = pairs > 0.0 ? std::sqrt(std::max(in_phase, 0.0) / pairs) : not_a_number;
        r.first_spike_ms = 1e3 * first_s;
        responses.push_back(r);
    }
    return responses;
}

} // namespace shearwake::neural
