#include "config/read_envelope.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace shearwake {
namespace {

const Range frequencies = Range::between(1e-3, 1e5);
const Range shares = Range::between(0.0, 1.0);
/// A jump that is given no edge gets this one: the engines' time samples carry it.
constexpr double usual_edge_s = 250e-6;

/// The keys of a wave, each with what stands before it in its table.
struct WaveKeys {
    const char *frequency, *depth, *phase, *on, *duty, *edge;
};
constexpr WaveKeys am_keys = {"am_frequency_Hz", "am_depth", "am_phase_deg",
                              "am_on",           "am_duty",  "am_edge_us"};
constexpr WaveKeys gain_keys = {"frequency_Hz", "depth", "phase_deg", "on", "duty", "edge_us"};

GainOn read_on(Reader& reader, const char* key) {
    static const std::array<std::string, 2> quantities = {"force", "pressure"};
    return reader.choice_or(key, "force", quantities) == "force" ? GainOn::force : GainOn::pressure;
}

SineGain read_sine(Reader& reader, const WaveKeys& keys) {
    return {
        .frequency_Hz = reader.number(keys.frequency, frequencies),
        .depth = reader.number_or(keys.depth, 1.0, shares),
        .phase_rad = reader.number_or(keys.phase, 0.0, Range::any()),
        .on = read_on(reader, keys.on),
    };
}

SquareGain read_square(Reader& reader, const WaveKeys& keys) {
    const std::size_t before = reader.findings().errors();
    const SineGain wave = read_sine(reader, keys);
    SquareGain square = {.frequency_Hz = wave.frequency_Hz,
                         .duty = reader.number_or(keys.duty, 0.5, Range::inside(0.0, 1.0)),
                         .depth = wave.depth,
                         .phase_rad = wave.phase_rad,
                         .on = wave.on};
    // From the end of one edge to the next, at most half of the shorter part of a period.
    const double shorter_s = std::min(square.duty, 1.0 - square.duty) / square.frequency_Hz;
    square.edge_s =
        reader.number_or(keys.edge, std::min(usual_edge_s, 0.5 * shorter_s), Range::at_least(1.0));
    if (reader.findings().errors() == before && reader.has(keys.frequency) &&
        square.edge_s > shorter_s * (1.0 + 1e-12))
        reader.error(keys.edge, fmt::format("must be at most {:.6g}, the shorter part of a period, "
                                            "and is {:.6g}",
                                            1e6 * shorter_s, 1e6 * square.edge_s));
    return square;
}

RampGain read_ramp(Reader& reader) {
    return {.duration_s = reader.number("duration_ms", Range::above(0.0)),
            .start_s = reader.number_or("start_ms", 0.0, Range::at_least(0.0)),
            .from = reader.number_or("from", 0.0, shares),
            .to = reader.number_or("to", 1.0, shares),
            .on = read_on(reader, "on")};
}

WindowGain read_window(Reader& reader) {
    const std::size_t before = reader.findings().errors();
    WindowGain window = {.from_s = reader.number_or("from_ms", 0.0, Range::at_least(0.0)),
                         .to_s = reader.number("to_ms", Range::above(0.0)),
                         .on = read_on(reader, "on")};
    const double lasts_s = window.to_s - window.from_s;
    window.edge_s =
        reader.number_or("edge_us", std::min(usual_edge_s, 0.5 * lasts_s), Range::at_least(1.0));
    if (reader.findings().errors() != before || !reader.has("to_ms")) return window;
    if (!(lasts_s > 0.0))
        reader.error("to_ms", fmt::format("must be after from_ms = {:.6g}, and is {:.6g}",
                                          1e3 * window.from_s, 1e3 * window.to_s));
    else if (2.0 * window.edge_s > lasts_s * (1.0 + 1e-12))
        reader.error("edge_us", fmt::format("must be at most {:.6g}, half of the window, and is "
                                            "{:.6g}",
                                            0.5e6 * lasts_s, 1e6 * window.edge_s));
    return window;
}

} // namespace

Gain read_am_gain(Reader& reader) {
    static const std::array<std::string, 2> waves = {"sine", "square"};
    const bool square = reader.choice_or("am_wave", "sine", waves) == "square";
    if (square) return read_square(reader, am_keys);
    for (const char* key : {"am_duty", "am_edge_us"})
        if (reader.has(key)) reader.error(key, "has a meaning only with am_wave = \"square\"");
    return read_sine(reader, am_keys);
}

Gain read_gain(Reader reader) {
    static const std::array<std::string, 4> shapes = {"sine", "square", "ramp", "window"};
    if (reader.empty()) return SineGain{};
    const auto shape = reader.find_choice("shape", shapes);
    if (!shape) { // its other keys are another shape's
        if (!reader.has("shape")) reader.error("shape", "is missing");
        return SineGain{};
    }
    Gain gain;
    if (shape == "sine") gain = read_sine(reader, gain_keys);
    if (shape == "square") gain = read_square(reader, gain_keys);
    if (shape == "ramp") gain = read_ramp(reader);
    if (shape == "window") gain = read_window(reader);
    reader.finish();
    return gain;
}

} // namespace shearwake
