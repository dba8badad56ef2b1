// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_envelope.hpp"

#include "config/sections/read_fields.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

/// Sets an edge that is not given, and checks the relations between the numbers of a gain. `read`:
/// no errors so far. Most gains require nothing.
void settle(Reader&, const FieldReader::Table&, bool, auto&) {}

void settle(Reader& reader, const FieldReader::Table& table, bool read, SquareGain& square) {
    // From the end of one edge to the next, at most half of the shorter part of a period.
    const double shorter_s = std::min(square.duty, 1.0 - square.duty) / square.frequency_Hz;
    const std::string key = std::string(table.prefix) + "edge_us";
    if (!reader.has(key)) square.edge_s = std::min(usual_edge_s, 0.5 * shorter_s);
    if (read && reader.has(std::string(table.prefix) + "frequency_Hz") &&
        square.edge_s > shorter_s * (1.0 + 1e-12))
        reader.error(
            key, fmt::format("must be at most {:.6g}, the shorter part of a period, but is {:.6g}",
                             1e6 * shorter_s, 1e6 * square.edge_s));
}

void settle(Reader& reader, const FieldReader::Table&, bool read, WindowGain& window) {
    const double lasts_s = window.to_s - window.from_s;
    if (!reader.has("edge_us")) window.edge_s = std::min(usual_edge_s, 0.5 * lasts_s);
    if (!read || !reader.has("to_ms")) return;
    if (!(lasts_s > 0.0))
        reader.error("to_ms", fmt::format("must be after from_ms = {:.6g}, but is {:.6g}",
                                          1e3 * window.from_s, 1e3 * window.to_s));
    else if (2.0 * window.edge_s > lasts_s * (1.0 + 1e-12))
        reader.error("edge_us",
                     fmt::format("must be at most {:.6g}, half of the window, but is {:.6g}",
                                 0.5e6 * lasts_s, 1e6 * window.edge_s));
}

void settle(Reader& reader, const FieldReader::Table&, bool read, SampledGain& sampled) {
    if (!read || !reader.has("values")) return;
    if (sampled.values.size() < 2)
        reader.error("values", fmt::format("must contain at least two numbers, but has {}",
                                           sampled.values.size()));
    else if (sampled.values.size() > most_samples)
        reader.error("values", fmt::format("must contain at most {} numbers, but has {}",
                                           most_samples, sampled.values.size()));
}

Gain read_shape(Reader& reader, const std::string& shape, const FieldReader::Table& table = {}) {
    const std::size_t before = reader.diagnostics().errors();
    Gain gain = read_alternative<Gain>(reader, shape, table).value_or(SineGain{});
    const bool read = reader.diagnostics().errors() == before;
    std::visit([&](auto& alternative) { settle(reader, table, read, alternative); }, gain);
    return gain;
}

} // namespace

Gain read_am_gain(Reader& reader) {
    static const std::array<std::string, 2> waves = {"sine", "square"};
    const bool square = reader.choice_or("am_wave", "sine", waves) == "square";
    if (square) return read_shape(reader, "square", {.prefix = "am_"});
    for (const char* key : {"am_duty", "am_edge_us"})
        if (reader.has(key)) reader.error(key, "applies only with am_wave = \"square\"");
    return read_shape(reader, "sine", {.prefix = "am_"});
}

Gain read_gain(Reader reader) {
    if (reader.empty()) return SineGain{};
    const auto shape = reader.find_choice("shape", alternative_names<Gain>());
    if (!shape) { // its other keys belong to another shape
        if (!reader.has("shape")) reader.error("shape", "is missing");
        return SineGain{};
    }
    Gain gain = read_shape(reader, *shape);
    reader.finish();
    return gain;
}

} // namespace shearwake::config
