// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/check_stimulus.hpp"

#include "neural/fibre/afferent.hpp"
#include "neural/skin/resample.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

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

PinStimulus without_overlap(PinStimulus stimulus) {
    stimulus.radius_mm = fitting_radius_mm(stimulus.at_mm, stimulus.radius_mm);
    return stimulus;
}

} // namespace shearwake::neural
