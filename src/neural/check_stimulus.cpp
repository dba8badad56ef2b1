#include "neural/check_stimulus.hpp"

#include "neural/resample.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::neural {
namespace {

/// Pacinian neurons let 370 Hz through: with fewer samples these are not there.
constexpr double least_rate_Hz = 800.0;
/// Contact is solved with all pins at once, with the cube of their number.
constexpr std::size_t most_pins = 1000;

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

/// Whether all is finite.
bool check_values(const PinStimulus& s, Remarks& remarks) {
    const Lines& lines = s.indentation_mm;
    if (lines.samples < 2) {
        remarks.error("trace", "a trace needs 2 samples at least, and has {}", lines.samples);
        return false;
    }
    std::size_t bad = 0, first = 0;
    for (std::size_t n = 0; n < lines.values.size(); ++n)
        if (!std::isfinite(lines.values[n]) && bad++ == 0) first = n;
    if (bad == 0) return true;
    remarks.error("trace",
                  "{} values are not finite, the first at pin {}, sample {} (counted from "
                  "0; {:g} ms)",
                  bad, first / lines.samples, first % lines.samples,
                  1e3 * static_cast<double>(first % lines.samples) / s.rate_Hz);
    return false;
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
void check_ends(const PinStimulus& s, double silence_s, Remarks& remarks) {
    constexpr double rounding = 1e-6; // of the largest value
    double start = 0.0, jump = 0.0, largest = 0.0;
    for (std::size_t p = 0; p < s.indentation_mm.count; ++p) {
        const auto line = s.indentation_mm.line(p);
        start = std::max(start, std::abs(line.front()));
        jump = std::max(jump, std::abs(line.front() - line.back()));
        for (const double value : line)
            largest = std::max(largest, std::abs(value));
    }
    if (silence_s > 0.0 && start > rounding * largest)
        remarks.warning("trace",
                        "it begins at {:.3g} um: after the silence that is a step, which is felt",
                        1e3 * start);
    if (!(silence_s > 0.0) && !is_neuron_rate(s.rate_Hz) && jump > rounding * largest)
        remarks.warning("silence_ms",
                        "without silence the jump of {:.3g} um between the last and the first "
                        "sample rings at both ends, at all distances at once",
                        1e3 * jump);
}

} // namespace

std::vector<Remark> check_stimulus(const PinStimulus& stimulus, double silence_s,
                                   const Polygon& skin_mm) {
    Remarks remarks;
    if (!std::isfinite(stimulus.rate_Hz) || !(stimulus.rate_Hz > 0.0)) {
        remarks.error("trace", "the sampling rate must be above 0, and is {:g} Hz",
                      stimulus.rate_Hz);
        return remarks.all;
    }
    check_pins(stimulus, skin_mm, remarks);
    if (!check_values(stimulus, remarks)) return remarks.all;
    if (stimulus.rate_Hz < least_rate_Hz)
        remarks.warning("trace",
                        "{:g} samples a second carry vibrations up to {:g} Hz; Pacinian afferents "
                        "follow them up to 370 Hz",
                        stimulus.rate_Hz, 0.5 * stimulus.rate_Hz);
    check_signs(stimulus, remarks);
    check_ends(stimulus, silence_s, remarks);
    return remarks.all;
}

PinStimulus without_overlap(PinStimulus stimulus) {
    stimulus.radius_mm = fitting_radius_mm(stimulus.at_mm, stimulus.radius_mm);
    return stimulus;
}

} // namespace shearwake::neural
