// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/silence.hpp"

#include "neural/fibre/afferent.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::neural {
namespace {

/// Whether the duration of these samples is an integer number of samples of the neurons.
bool lasts_whole_samples(std::size_t samples, double rate_Hz) {
    const double neuron_samples = static_cast<double>(samples) / rate_Hz * neuron_rate_Hz;
    return std::abs(neuron_samples - std::round(neuron_samples)) < 1e-6;
}

} // namespace

SilencedLines with_silence(const Lines& lines, double rate_Hz, double silence_s) {
    if (!(silence_s > 0.0)) return {lines, 0.0};
    constexpr std::size_t most_lengthened = 10000;
    const auto silent = static_cast<std::size_t>(std::ceil(silence_s * rate_Hz - 1e-9));
    std::size_t samples = lines.samples + 2 * silent;
    for (std::size_t more = 0; more < most_lengthened; ++more)
        if (lasts_whole_samples(samples + more, rate_Hz)) {
            samples += more;
            break;
        }
    SilencedLines out{Lines(lines.count, samples), static_cast<double>(silent) / rate_Hz};
    for (std::size_t p = 0; p < lines.count; ++p) {
        const auto from = lines.line(p);
        const auto to = out.lines.line(p);
        std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(silent));
        for (std::size_t k = 0; k + 1 < silent && !from.empty(); ++k) {
            const double phase =
                0.5 * std::numbers::pi * static_cast<double>(k + 1) / static_cast<double>(silent);
            to[silent + lines.samples + k] = from.back() * std::pow(std::cos(phase), 2);
        }
    }
    return out;
}

SilencedStimulus with_silence(const PinStimulus& stimulus, double silence_s) {
    SilencedLines silenced = with_silence(stimulus.indentation_mm, stimulus.rate_Hz, silence_s);
    return {{.at_mm = stimulus.at_mm,
             .radius_mm = stimulus.radius_mm,
             .rate_Hz = stimulus.rate_Hz,
             .indentation_mm = std::move(silenced.lines)},
            silenced.before_s};
}

} // namespace shearwake::neural
