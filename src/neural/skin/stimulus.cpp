// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/stimulus.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "neural/fibre/fibre.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace shearwake::neural {
namespace {

/// Pacinian neurons respond up to 370 Hz, which fewer samples cannot represent.
constexpr double least_rate_Hz = 800.0;
/// The contact problem is solved for all pins together at a cost that grows with the cube of their
/// number.
constexpr std::size_t most_pins = 1000;
/// Skin moves at frequencies from a few Hz to some kHz; ultrasound carriers are sampled at some
/// MHz.
constexpr double slowest_Hz = 0.1, fastest_Hz = 1e9;
/// Total number of samples of all traces (2 GB).
constexpr double most_resampled = 2.5e8;

using Traces = std::vector<std::span<const double>>;

/// The quantity of a trace, and the unit in which messages report its values.
struct Kind {
    const char* noun;
    const char* unit;
    double shown; // factor from the stored to the reported unit
};
constexpr Kind of_pins{"pin", "um", 1e3}, of_receptors{"receptor", "Pa", 1.0};

class Remarks {
public:
    template <class... T>
    void error(const char* key, fmt::format_string<T...> text, T&&... values) {
        all.push_back({Severity::error, key, fmt::format(text, std::forward<T>(values)...)});
    }
    template <class... T>
    void warning(const char* key, fmt::format_string<T...> text, T&&... values) {
        all.push_back({Severity::warning, key, fmt::format(text, std::forward<T>(values)...)});
    }
    std::vector<Remark> all;
};

void check_pins(const PinStimulus& s, const Polygon& skin_mm, Remarks& remarks) {
    if (s.at_mm.empty()) remarks.error("pins", "no pins are given");
    if (s.at_mm.size() > most_pins)
        return remarks.error("pins", "{} pins exceed the limit of the contact solver, {}",
                             s.at_mm.size(), most_pins);
    if (!std::isfinite(s.radius_mm) || !(s.radius_mm > 0.0)) {
        remarks.error("pin_radius_mm", "must be above 0, and is {:g}", s.radius_mm);
        return;
    }
    const double fitting = fitting_radius_mm(s.at_mm, s.radius_mm);
    if (!(fitting > 0.0))
        remarks.error("pins", "two pins are at the same position");
    else if (fitting < s.radius_mm)
        remarks.warning("pin_radius_mm",
                        "pins of radius {:g} mm overlap; {:g} mm, half of their smallest distance, "
                        "is used instead",
                        s.radius_mm, fitting);
    if (skin_mm.empty() || s.at_mm.empty()) return;
    const auto off = static_cast<std::size_t>(std::count_if(
        s.at_mm.begin(), s.at_mm.end(), [&](Vec2 at_mm) { return !contains(skin_mm, at_mm); }));
    if (off == s.at_mm.size())
        remarks.error("pins",
                      "{} outside of the skin of the hand, so that no receptor would respond; "
                      "move the patch",
                      off == 1 ? "the only pin is" : fmt::format("all {} pins are", off));
    else if (off > 0)
        remarks.warning("pins",
                        "{} of {} pins {} outside of the skin of the hand and {} not emit "
                        "waves; move the patch if this is not intended",
                        off, s.at_mm.size(), off == 1 ? "is" : "are", off == 1 ? "does" : "do");
}

/// Checks the sampling rate and the total size of the traces.
bool check_rate(double rate_Hz, const Traces& traces, Remarks& remarks) {
    if (!std::isfinite(rate_Hz) || !(rate_Hz > 0.0)) {
        remarks.error("trace", "the sampling rate must be above 0, and is {:g} Hz", rate_Hz);
        return false;
    }
    if (rate_Hz < slowest_Hz || rate_Hz > fastest_Hz) {
        remarks.error("trace", "the sampling rate must be between {:g} and {:g} Hz, and is {:g} Hz",
                      slowest_Hz, fastest_Hz, rate_Hz);
        return false;
    }
    const std::size_t samples = traces.empty() ? 0 : traces.front().size();
    const double resampled = static_cast<double>(samples) / rate_Hz * neuron_rate_Hz;
    if (resampled * static_cast<double>(traces.size()) <= most_resampled) return true;
    remarks.error("trace",
                  "{} traces of {:.4g} s have {:.2g} samples at the rate of the neurons, {:g} Hz; "
                  "at most {:.2g} are possible",
                  traces.size(), static_cast<double>(samples) / rate_Hz,
                  resampled * static_cast<double>(traces.size()), neuron_rate_Hz, most_resampled);
    return false;
}

/// Whether the traces have enough samples and all values are finite.
bool check_values(const Traces& traces, double rate_Hz, const Kind& kind, Remarks& remarks) {
    const std::size_t samples = traces.empty() ? 0 : traces.front().size();
    if (samples < 2) {
        remarks.error("trace", "a trace must have at least 2 samples, and has {}", samples);
        return false;
    }
    std::size_t bad = 0, first = 0, first_trace = 0;
    for (std::size_t i = 0; i < traces.size(); ++i)
        for (std::size_t k = 0; k < samples; ++k)
            if (!std::isfinite(traces[i][k]) && bad++ == 0) first_trace = i, first = k;
    if (bad == 0) return true;
    remarks.error("trace",
                  "{} values are not finite, the first at {} {}, sample {} (counted from "
                  "0; {:g} ms)",
                  bad, kind.noun, first_trace, first, 1e3 * static_cast<double>(first) / rate_Hz);
    return false;
}

void check_sampling(double rate_Hz, Remarks& remarks) {
    if (rate_Hz < least_rate_Hz)
        remarks.warning("trace",
                        "a sampling rate of {:g} Hz represents vibrations up to {:g} Hz, but "
                        "Pacinian afferents respond up to 370 Hz; use at least {:g} Hz",
                        rate_Hz, 0.5 * rate_Hz, least_rate_Hz);
}

void check_signs(const PinStimulus& s, Remarks& remarks) {
    const Lines& lines = s.indentation_mm;
    std::size_t mixed = 0;
    for (std::size_t k = 0; k < lines.samples; ++k) {
        bool up = false, down = false;
        for (std::size_t p = 0; p < lines.count; ++p) {
            up = up || lines.line(p)[k] < 0.0;
            down = down || lines.line(p)[k] > 0.0;
        }
        mixed += up && down;
    }
    if (mixed > 0)
        remarks.warning("trace",
                        "at {} of {} samples some pins press and others pull; the model of pins "
                        "glued to the skin is valid only if all have the same sign; keep only the "
                        "pins near the focus, or use afferents.input = \"stress\"",
                        mixed, lines.samples);
}

/// Without silence the first sample is a step from zero, and the resampled trace rings.
void check_ends(const Traces& traces, double rate_Hz, double silence_s, const Kind& kind,
                Remarks& remarks) {
    constexpr double rounding = 1e-6; // relative to the largest value
    double start = 0.0, jump = 0.0, largest = 0.0;
    for (const auto line : traces) {
        start = std::max(start, std::abs(line.front()));
        jump = std::max(jump, std::abs(line.front() - line.back()));
        for (const double value : line)
            largest = std::max(largest, std::abs(value));
    }
    if (silence_s > 0.0 && start > rounding * largest)
        remarks.warning("trace",
                        "the trace begins at {:.3g} {} instead of 0; this step after the initial "
                        "silence itself causes a response; let it begin at 0, or ramp it",
                        kind.shown * start, kind.unit);
    if (!(silence_s > 0.0) && !is_neuron_rate(rate_Hz) && jump > rounding * largest)
        remarks.warning("silence_ms",
                        "without silence, the jump of {:.3g} {} between the last and the first "
                        "sample causes ringing at both ends, simultaneously at all distances; use "
                        "silence_ms",
                        kind.shown * jump, kind.unit);
}

} // namespace

std::vector<Remark> check_stimulus(const PinStimulus& stimulus, double silence_s,
                                   const Polygon& skin_mm, Course course) {
    Remarks remarks;
    Traces traces;
    for (std::size_t p = 0; p < stimulus.indentation_mm.count; ++p)
        traces.push_back(stimulus.indentation_mm.line(p));
    if (!check_rate(stimulus.rate_Hz, traces, remarks)) return remarks.all;
    check_pins(stimulus, skin_mm, remarks);
    if (!check_values(traces, stimulus.rate_Hz, of_pins, remarks)) return remarks.all;
    check_sampling(stimulus.rate_Hz, remarks);
    check_signs(stimulus, remarks);
    if (course == Course::once) check_ends(traces, stimulus.rate_Hz, silence_s, of_pins, remarks);
    return remarks.all;
}

std::vector<Remark> check_stress(std::span<const std::vector<double>> compression_Pa,
                                 double rate_Hz, std::size_t afferents, double silence_s,
                                 Course course) {
    Remarks remarks;
    const Traces traces(compression_Pa.begin(), compression_Pa.end());
    if (!check_rate(rate_Hz, traces, remarks)) return remarks.all;
    if (compression_Pa.size() != afferents) {
        remarks.error("trace", "expected {} traces of stress, one per receptor, but found {}",
                      afferents, compression_Pa.size());
        return remarks.all;
    }
    if (afferents == 0) return remarks.all;
    if (!check_values(traces, rate_Hz, of_receptors, remarks)) return remarks.all;
    check_sampling(rate_Hz, remarks);
    if (course == Course::once) check_ends(traces, rate_Hz, silence_s, of_receptors, remarks);
    return remarks.all;
}

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

} // namespace shearwake::neural
