// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"

#include "config/document/key_range.hpp"
#include "config/sections/read_fields.hpp"
#include "config/sections/read_path.hpp"
#include "problem/load/load_fields.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

/// The numbers of a gain are compared with each other only if each is valid.
Gain read_shape(Reader& reader, const std::string& shape, const FieldReader::Table& table = {}) {
    const std::size_t before = reader.diagnostics().errors();
    Gain gain = read_alternative<Gain>(reader, shape, table).value_or(SineGain{});
    const bool read = reader.diagnostics().errors() == before;
    const auto complete = [&](auto& alternative) {
        if constexpr (requires { alternative.complete(); }) {
            const auto conflict = alternative.complete();
            if (conflict && read)
                reader.error(std::string(table.prefix) + conflict->key, conflict->message);
        }
    };
    std::visit(complete, gain);
    return gain;
}

/// The keys am_... of a modulation: a sine or a square wave.
Gain read_am_gain(Reader& reader) {
    const std::string wave = read_optional_word(reader, field_of<Modulation>("am_wave"));
    each_am_key([&](const auto&, const Field& field, const std::string& has_key) {
        if (*field.only_with && wave != has_key && reader.has(field.key))
            reader.error(field.key, std::string("applies only with ") + field.only_with);
    });
    return read_shape(reader, wave, {.prefix = "am_"});
}

/// One table of [[load.modulation.envelope]].
Gain read_gain(Reader reader) {
    if (reader.empty()) return SineGain{};
    const auto shape = reader.find_choice("shape", alternative_names<Gain>());
    if (!shape) { // its other keys belong to another shape
        reader.report_missing("shape");
        return SineGain{};
    }
    Gain gain = read_shape(reader, *shape);
    reader.finish();
    return gain;
}

/// The kinds to which a key applies. Keys of all kinds are not listed.
struct KindKey {
    std::string_view key;
    std::string_view kinds; // separated by blanks
};
constexpr std::string_view along_paths = "STM AM-STM SM-STM DTP STP";
constexpr std::string_view at_constant_speed = "STM AM-STM DTP STP";
constexpr std::string_view amplitude_modulated = "AM AM-STM DTP";
/// All that do not apply to every kind.
const std::vector<KindKey>& kind_keys() {
    static const std::vector<KindKey> all = [] {
        std::vector<KindKey> keys = {
            {"position_mm", "AM LM file"},
            {"file", "file"},
            {"at_end", "file"},
            {"path", along_paths},
            {"speed_m_s", along_paths},
            {"mach", along_paths},
            {"draw_frequency_Hz", along_paths},
            {"corner_dwell_ms", at_constant_speed},
            {"corner_slow_mm", at_constant_speed},
            {"corner_slow_to", at_constant_speed},
            {"am_wave", amplitude_modulated},
            {"speed_deviation_m_s", "SM-STM"},
            {"sm_frequency_Hz", "SM-STM"},
            {"sm_phase_deg", "SM-STM"},
            {"lm_amplitude_mm", "LM"},
            {"lm_angle_deg", "LM"},
            {"lm_frequency_Hz", "LM"},
            {"lm_phase_deg", "LM"},
            {"lm_wave", "LM"},
            {"pattern", "STP"},
            {"pattern_frequency_Hz", "STP"},
            {"trajectory", "custom"},
        };
        each_am_key([&](const auto&, const Field& field, const char*) {
            keys.push_back({field.key, amplitude_modulated});
        });
        return keys;
    }();
    return all;
}

bool contains_word(std::string_view words, std::string_view word) {
    while (!words.empty()) {
        const std::size_t blank = std::min(words.find(' '), words.size());
        if (words.substr(0, blank) == word) return true;
        words.remove_prefix(std::min(blank + 1, words.size()));
    }
    return false;
}

/// A short line through the centre, traversed back and forth.
Swing read_lateral(Reader& reader) {
    const double angle = read_optional_number(reader, field_of<Modulation>("lm_angle_deg"));
    const double amplitude_m =
        reader.number("lm_amplitude_mm", range_of<Modulation>("lm_amplitude_mm"));
    Swing swing{.amplitude_m = {amplitude_m * std::cos(angle), amplitude_m * std::sin(angle)}};
    read_fields(reader, swing, {.prefix = "lm_", .without = {"amplitude_mm"}});
    return swing;
}

/// The small, fast figure around the moving centre. Open figures are traversed back and forth.
Travel read_pattern(Reader& reader, const PathContext& context) {
    const double frequency_Hz =
        reader.number("pattern_frequency_Hz", range_of<Modulation>("pattern_frequency_Hz"));
    const PathAndEnd read = read_path(reader.table("pattern"), context, LeastLength::none);
    Travel travel{.path = read.path, .at_end = read.at_end};
    if (read.rests)
        reader.error("pattern", "has a file with the time at each point, but pattern_frequency_Hz "
                                "states the speed; remove the columns");
    if (!is_closed(read.path) && !read.end_is_given) travel.at_end = AtEnd::back_and_forth;
    if (travel.at_end == AtEnd::off || travel.at_end == AtEnd::hold)
        reader.error("pattern",
                     "is drawn repeatedly, so its at_end must be \"repeat\" or \"back-and-forth\"");
    travel.motion = ConstantSpeed{cycle_m(travel) * frequency_Hz};
    return travel;
}

/// Reads one table of [[load.modulation.trajectory]].
Mover read_mover(Reader reader, const PathContext& context) {
    static const std::array<std::string, 3> moves = {Hold::name, Swing::name, "path"};
    if (reader.empty()) return Hold{};
    const auto move = reader.find_choice("move", moves);
    if (!move) { // its other keys belong to some move
        reader.report_missing("move");
        return Hold{};
    }
    Mover mover;
    if (const auto read = read_alternative<Mover>(reader, *move)) mover = *read;
    if (move == "path") mover = read_travel(reader, context, SpeedKind::either);
    reader.finish();
    return mover;
}

Trajectory read_trajectory(Reader& reader, std::string_view kind, const PathContext& context) {
    Trajectory trajectory;
    auto& parts = trajectory.parts;
    if (kind == "custom") {
        const std::vector<Reader> movers = reader.tables("trajectory");
        for (const Reader& mover : movers)
            parts.push_back(read_mover(mover, context));
        if (!reader.has("trajectory"))
            reader.missing("trajectory");
        else if (movers.empty())
            reader.error("trajectory", "must be a list of at least one table");
    } else if (kind == "AM" || kind == "LM") {
        parts.push_back(Hold{reader.point_or("position_mm", {})});
        if (kind == "LM") parts.push_back(read_lateral(reader));
    } else {
        parts.push_back(read_travel(
            reader, context, kind == "SM-STM" ? SpeedKind::oscillating : SpeedKind::constant));
        if (kind == "STP") parts.push_back(read_pattern(reader, context));
    }
    return trajectory;
}

/// Simultaneous foci relative to the moving point.
std::vector<Vec2> read_foci_m(Reader& reader) {
    const auto foci_m = reader.find_points("foci_mm");
    if (!foci_m) return {};
    if (foci_m->empty()) reader.error("foci_mm", "must contain at least one focus");
    for (std::size_t i = 0; i < foci_m->size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if ((*foci_m)[i] == (*foci_m)[j])
                reader.error("foci_mm",
                             fmt::format("has foci {} and {} at the same position", j + 1, i + 1));
    return *foci_m;
}

void settle_other_kinds(Reader& reader, std::string_view kind, OtherKinds other_kinds) {
    for (const KindKey& other : kind_keys()) {
        if (contains_word(other.kinds, kind)) continue;
        if (reader.has(other.key) && other_kinds == OtherKinds::refused)
            reader.error(other.key, fmt::format("does not apply to kind {}", kind));
    }
}

} // namespace

bool has_meaning(std::string_view key, std::string_view kind) {
    for (const KindKey& known : kind_keys()) {
        const bool is_it = key.starts_with(known.key) &&
                           (key.size() == known.key.size() || key[known.key.size()] == '.' ||
                            key[known.key.size()] == '[');
        if (is_it) return contains_word(known.kinds, kind);
    }
    return true;
}

namespace {

Modulation read_modulation(Reader& reader, const Medium& medium, OtherKinds other_kinds,
                           const TextLoader& load_text, Footprint& footprint) {
    if (reader.empty()) return {};
    Modulation modulation;
    if (!reader.has("kind")) reader.missing("kind");
    const auto kind = reader.find_choice("kind", words_of(field_of<Modulation>("kind")));
    const auto ramp_s = reader.find_number("ramp_ms", range_of<Modulation>("ramp_ms"));
    std::vector<Gain> more_gains;
    for (const Reader& gain : reader.tables("envelope"))
        more_gains.push_back(read_gain(gain));
    if (!kind) { // the applicable keys are unknown
        for (const KindKey& known : kind_keys())
            reader.allow(std::array{known.key});
        reader.finish();
        return modulation;
    }
    modulation.kind = *kind;
    if (*kind == "file")
        read_played(reader, {medium, load_text}, footprint, modulation);
    else
        modulation.trajectory = read_trajectory(reader, *kind, {medium, load_text});
    modulation.foci_m = read_foci_m(reader);
    auto& gains = modulation.envelope.gains;
    if (contains_word(amplitude_modulated, *kind)) gains.push_back(read_am_gain(reader));
    gains.insert(gains.end(), more_gains.begin(), more_gains.end());
    if (ramp_s) gains.push_back(RampGain{*ramp_s});
    settle_other_kinds(reader, *kind, other_kinds);
    reader.finish();
    return modulation;
}

Carrier read_array_carrier(Reader& reader) {
    ResolvedCarrier resolved;
    read_fields(reader, resolved);
    if (reader.find_choice("carrier", alternative_names<Carrier>()) == ResolvedCarrier::name)
        return resolved;
    if (reader.has("carrier_kHz"))
        reader.error("carrier_kHz", "applies only with carrier = \"resolved\"");
    return AveragedCarrier{};
}

/// The pattern of a lens can neither move nor be multiplied.
void check_static(Reader& reader, const Modulation& modulation) {
    if (greatest_speed_m_s(modulation.trajectory) > 0.0)
        reader.error("kind", "moves the focus, but the pattern of a lens is static: use kind = "
                             "\"AM\", or footprint.shape = \"array\"");
    if (!modulation.foci_m.empty())
        reader.error("foci_mm", "does not apply to a lens, whose foci are those of "
                                "load.footprint.target_foci_mm");
}

} // namespace

Load read_load(Reader& reader, const Medium& medium, OtherKinds other_kinds,
               const FileLoaders& files) {
    if (reader.empty()) return {};
    Load load;
    const auto peak_Pa = reader.find_number("peak_Pa", range_of<Load>("peak_Pa"));
    const FootprintAndPeak read = read_footprint(reader.table("footprint"), files);
    load.footprint = read.footprint;
    load.peak_Pa = peak_Pa.value_or(read.peak_Pa.value_or(1.0));
    const bool is_lens = std::holds_alternative<LensFootprint>(load.footprint);
    if (read.defines_peak && reader.has("peak_Pa"))
        reader.conflict(
            "peak_Pa",
            fmt::format("and load.footprint.{} are both given; remove one of them from the job",
                        is_lens ? "pressure_Pa" : "pressure_Pa_m"));
    if (!read.defines_peak && !reader.has("peak_Pa")) {
        if (is_lens)
            reader.error("peak_Pa", "is missing (or load.footprint.pressure_Pa, the amplitude of "
                                    "the sound behind the lens)");
        else if (std::holds_alternative<ArrayFootprint>(load.footprint))
            reader.error("peak_Pa", "is missing (or load.footprint.pressure_Pa_m, the strength of "
                                    "the array's pistons)");
        else
            reader.missing("peak_Pa");
    }
    load.carrier = read_array_carrier(reader);
    Reader modulation = reader.table("modulation");
    load.modulation =
        read_modulation(modulation, medium, other_kinds, files.load_text, load.footprint);
    if (is_lens) check_static(modulation, load.modulation);
    reader.finish();
    return load;
}

} // namespace shearwake::config
