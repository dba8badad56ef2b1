#include "neural/check_stimulus.hpp"

#include "neural/resample.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <span>

namespace shearwake::neural {
namespace {

/// Pacinian neurons let 370 Hz through: with fewer samples these are not there.
constexpr double least_rate_Hz = 800.0;
/// Contact is solved with all pins at once, with the cube of their number.
constexpr std::size_t most_pins = 1000;

using Traces = std::vector<std::span<const double>>;

/// What traces are of, and how a value of theirs is told.
struct Kind {
    const char* noun;
    const char* unit;
    double shown; // a value, in that unit
};
constexpr Kind pins{"pin", "um", 1e3}, receptors{"receptor", "Pa", 1.0};

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
    if (s.at_mm.empty()) remarks.error("pins", "there is no pin");
    if (s.at_mm.size() > most_pins)
        remarks.error("pins", "{} pins are too many for their contact: at most {}", s.at_mm.size(),
                      most_pins);
    if (!std::isfinite(s.radius_mm) || !(s.radius_mm > 0.0)) {
        remarks.error("pin_radius_mm", "must be above 0, and is {:g}", s.radius_mm);
        return;
    }
    const double fitting = fitting_radius_mm(s.at_mm, s.radius_mm);
    if (!(fitting > 0.0))
        remarks.error("pins", "two pins stand at the same place");
    else if (fitting < s.radius_mm)
        remarks.warning("pin_radius_mm",
                        "pins of radius {:g} mm overlap; {:g} mm is taken, half their smallest "
                        "distance",
                        s.radius_mm, fitting);
    if (skin_mm.empty() || s.at_mm.empty()) return;
    const auto off = static_cast<std::size_t>(std::count_if(
        s.at_mm.begin(), s.at_mm.end(), [&](Vec2 at_mm) { return !contains(skin_mm, at_mm); }));
    if (off == s.at_mm.size())
        remarks.error("pins",
                      "all {} pins lie off the skin of the hand: nothing would be felt; "
                      "move the patch",
                      off);
    else if (off > 0)
        remarks.warning("pins",
                        "{} of {} pins lie off the skin of the hand: no wave comes from "
                        "them",
                        off, s.at_mm.size());
}

bool check_rate(double rate_Hz, Remarks& remarks) {
    if (std::isfinite(rate_Hz) && rate_Hz > 0.0) return true;
    remarks.error("trace", "the sampling rate must be above 0, and is {:g} Hz", rate_Hz);
    return false;
}

/// Whether all is there and finite.
bool check_values(const Traces& traces, double rate_Hz, const Kind& kind, Remarks& remarks) {
    const std::size_t samples = traces.empty() ? 0 : traces.front().size();
    if (samples < 2) {
        remarks.error("trace", "a trace needs 2 samples at least, and has {}", samples);
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
                        "{:g} samples a second carry vibrations up to {:g} Hz; Pacinian afferents "
                        "follow them up to 370 Hz",
                        rate_Hz, 0.5 * rate_Hz);
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
                        "at {} of {} samples some pins press and others pull: the model of glued "
                        "pins holds where all have one sign",
                        mixed, lines.samples);
}

/// Without silence the first sample is a step from nothing, and what is resampled rings.
void check_ends(const Traces& traces, double rate_Hz, double silence_s, const Kind& kind,
                Remarks& remarks) {
    constexpr double rounding = 1e-6; // of the largest value
    double start = 0.0, jump = 0.0, largest = 0.0;
    for (const auto line : traces) {
        start = std::max(start, std::abs(line.front()));
        jump = std::max(jump, std::abs(line.front() - line.back()));
        for (const double value : line)
            largest = std::max(largest, std::abs(value));
    }
    if (silence_s > 0.0 && start > rounding * largest)
        remarks.warning("trace",
                        "it begins at {:.3g} {}: after the silence that is a step, which is felt",
                        kind.shown * start, kind.unit);
    if (!(silence_s > 0.0) && !is_neuron_rate(rate_Hz) && jump > rounding * largest)
        remarks.warning("silence_ms",
                        "without silence the jump of {:.3g} {} between the last and the first "
                        "sample rings at both ends, at all distances at once",
                        kind.shown * jump, kind.unit);
}

} // namespace

std::vector<Remark> check_stimulus(const PinStimulus& stimulus, double silence_s,
                                   const Polygon& skin_mm) {
    Remarks remarks;
    if (!check_rate(stimulus.rate_Hz, remarks)) return remarks.all;
    check_pins(stimulus, skin_mm, remarks);
    Traces traces;
    for (std::size_t p = 0; p < stimulus.indentation_mm.count; ++p)
        traces.push_back(stimulus.indentation_mm.line(p));
    if (!check_values(traces, stimulus.rate_Hz, pins, remarks)) return remarks.all;
    check_sampling(stimulus.rate_Hz, remarks);
    check_signs(stimulus, remarks);
    check_ends(traces, stimulus.rate_Hz, silence_s, pins, remarks);
    return remarks.all;
}

std::vector<Remark> check_stress(std::span<const std::vector<double>> compression_Pa,
                                 double rate_Hz, std::size_t afferents, double silence_s) {
    Remarks remarks;
    if (!check_rate(rate_Hz, remarks)) return remarks.all;
    if (compression_Pa.size() != afferents) {
        remarks.error("trace", "there are {} receptors and {} traces of stress", afferents,
                      compression_Pa.size());
        return remarks.all;
    }
    if (afferents == 0) return remarks.all;
    const Traces traces(compression_Pa.begin(), compression_Pa.end());
    if (!check_values(traces, rate_Hz, receptors, remarks)) return remarks.all;
    check_sampling(rate_Hz, remarks);
    check_ends(traces, rate_Hz, silence_s, receptors, remarks);
    return remarks.all;
}

PinStimulus without_overlap(PinStimulus stimulus) {
    stimulus.radius_mm = fitting_radius_mm(stimulus.at_mm, stimulus.radius_mm);
    return stimulus;
}

} // namespace shearwake::neural
