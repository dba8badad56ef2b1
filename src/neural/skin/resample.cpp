// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/resample.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "neural/fibre/afferent.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace shearwake::neural {

std::size_t resampled_length(std::size_t samples, double rate_Hz) {
    return static_cast<std::size_t>(
        std::nearbyint(static_cast<double>(samples) / rate_Hz * neuron_rate_Hz));
}

bool is_neuron_rate(double rate_Hz) {
    return std::abs(rate_Hz - neuron_rate_Hz) <= 1e-9 * neuron_rate_Hz;
}

Lines at_neuron_rate(const Lines& lines, double rate_Hz) {
    if (is_neuron_rate(rate_Hz)) return lines;
    Lines out(lines.count, resampled_length(lines.samples, rate_Hz));
    FourierResampler resample(lines.samples, out.samples);
    std::size_t i = 0;
    for (; i + 1 < lines.count; i += 2)
        resample(lines.line(i), lines.line(i + 1), out.line(i), out.line(i + 1));
    if (i < lines.count) resample(lines.line(i), out.line(i));
    return out;
}

FourierResampler::FourierResampler(std::size_t from, std::size_t to)
    : from_(from), to_(to), forward_(static_cast<std::ptrdiff_t>(from), fft::Direction::forward),
      backward_(static_cast<std::ptrdiff_t>(to), fft::Direction::backward) {}

void FourierResampler::operator()(std::span<const double> line, std::span<double> resampled) {
    std::copy(line.begin(), line.end(), from_.begin());
    resample();
    for (std::size_t k = 0; k < to_.size(); ++k)
        resampled[k] = to_[k].real();
}

void FourierResampler::operator()(std::span<const double> line_a, std::span<const double> line_b,
                                  std::span<double> resampled_a, std::span<double> resampled_b) {
    // The operation maps real lines to real lines, so that a second line in the imaginary part
    // stays separate.
    for (std::size_t k = 0; k < from_.size(); ++k)
        from_[k] = {line_a[k], line_b[k]};
    resample();
    for (std::size_t k = 0; k < to_.size(); ++k) {
        resampled_a[k] = to_[k].real();
        resampled_b[k] = to_[k].imag();
    }
}

void FourierResampler::resample() {
    const std::size_t N = from_.size(), M = to_.size(), shorter = std::min(N, M);
    forward_.execute(from_.data());
    std::fill(to_.begin(), to_.end(), 0.0);
    to_[0] = from_[0];
    for (std::size_t f = 1; 2 * f < shorter; ++f) {
        to_[f] = from_[f];
        to_[M - f] = from_[N - f];
    }
    if (shorter % 2 == 0) { // the shorter spectrum has a single value for both +f and -f
        const std::size_t f = shorter / 2;
        if (M < N) {
            to_[f] = from_[f] + from_[N - f];
        } else if (M > N) {
            to_[f] = 0.5 * from_[f];
            to_[M - f] = 0.5 * from_[f];
        } else {
            to_[f] = from_[f];
        }
    }
    backward_.execute(to_.data());
    const double scale = 1.0 / static_cast<double>(N);
    for (std::complex<double>& value : to_)
        value *= scale;
}

namespace {

/// Angle 2 pi f t at sample k. Complete periods are subtracted first, so that it is exact after
/// millions of samples.
double turn(double frequency_Hz, double rate_Hz, std::size_t k) {
    const double periods = frequency_Hz * static_cast<double>(k) / rate_Hz;
    return two_pi * (periods - std::floor(periods));
}

} // namespace

PinStimulus carrier_stimulus(const CarrierInput& carrier, std::vector<Vec2> pins_mm,
                             double radius_mm, double duration_s) {
    const double rate_Hz = carrier.sampling_Hz;
    if (rate_Hz < fewest_samples_a_cycle * carrier.frequency_Hz * (1.0 - 1e-9))
        throw UsageError(fmt::format(
            "a carrier of {:g} kHz sampled at {:g} kHz has {:.3g} samples per cycle and aliases; "
            "at least {:g} are needed: set sampling_kHz to at least {:g}",
            1e-3 * carrier.frequency_Hz, 1e-3 * rate_Hz, rate_Hz / carrier.frequency_Hz,
            fewest_samples_a_cycle, 1e-3 * fewest_samples_a_cycle * carrier.frequency_Hz));
    PinStimulus stimulus{.at_mm = std::move(pins_mm), .radius_mm = radius_mm, .rate_Hz = rate_Hz};
    const auto samples = static_cast<std::size_t>(std::llround(duration_s * rate_Hz));
    stimulus.indentation_mm = Lines(stimulus.at_mm.size(), samples);
    std::vector<double> trace(samples);
    for (std::size_t k = 0; k < samples; ++k) {
        const double am = std::cos(turn(carrier.am_frequency_Hz, rate_Hz, k));
        const double m =
            carrier.am_frequency_Hz > 0.0 ? 1.0 - 0.5 * carrier.am_depth * (1.0 + am) : 1.0;
        const double mc = m * std::sin(turn(carrier.frequency_Hz, rate_Hz, k));
        trace[k] = 1e3 * carrier.amplitude_m *
                   (carrier.wave == CarrierWave::signed_     ? mc
                    : carrier.wave == CarrierWave::rectified ? std::max(mc, 0.0)
                                                             : mc * mc);
    }
    for (std::size_t p = 0; p < stimulus.at_mm.size(); ++p)
        std::copy(trace.begin(), trace.end(), stimulus.indentation_mm.line(p).begin());
    return stimulus;
}

namespace {

/// Whether the duration of these samples is an integer number of samples of the neurons.
bool has_integer_samples(std::size_t samples, double rate_Hz) {
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
        if (has_integer_samples(samples + more, rate_Hz)) {
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
