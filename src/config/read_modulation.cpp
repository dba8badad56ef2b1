#include "config/read_case.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace shearwake {
namespace {

const std::array<std::string, 4> kinds = {"STM", "AM", "AM-STM", "SM-STM"};

/// Which keys belong to which kinds. Those of every kind are not listed.
struct KindKey {
    std::string_view key;
    std::string_view kinds; // separated by blanks
};
constexpr std::array kind_keys = {
    KindKey{"position_mm", "AM"},
    KindKey{"path", "STM AM-STM SM-STM"},
    KindKey{"speed_m_s", "STM AM-STM SM-STM"},
    KindKey{"mach", "STM AM-STM SM-STM"},
    KindKey{"am_frequency_Hz", "AM AM-STM"},
    KindKey{"am_depth", "AM AM-STM"},
    KindKey{"am_phase_deg", "AM AM-STM"},
    KindKey{"am_on", "AM AM-STM"},
    KindKey{"speed_deviation_m_s", "SM-STM"},
    KindKey{"sm_frequency_Hz", "SM-STM"},
    KindKey{"sm_phase_deg", "SM-STM"},
};

bool holds_word(std::string_view words, std::string_view word) {
    while (!words.empty()) {
        const std::size_t blank = std::min(words.find(' '), words.size());
        if (words.substr(0, blank) == word) return true;
        words.remove_prefix(std::min(blank + 1, words.size()));
    }
    return false;
}

void read_path(Reader reader, Travel& travel) {
    static const std::array<std::string, 1> shapes = {"line"};
    static const std::array<std::string, 2> ends = {"off", "hold"};
    const std::size_t before = reader.findings().errors();
    reader.choice("shape", shapes);
    travel.path = {.from_m = reader.point("from_mm"), .to_m = reader.point("to_mm")};
    travel.at_end = reader.choice_or("at_end", "off", ends) == "off" ? AtEnd::off : AtEnd::hold;
    reader.finish();
    if (!reader.empty() && reader.findings().errors() == before &&
        travel.path.from_m == travel.path.to_m)
        reader.error("to_mm", "is where the path starts: it has no length");
}

double read_speed_m_s(Reader& reader, const Medium& medium) {
    const auto speed_m_s = reader.find_number("speed_m_s", Range::between(1e-6, 1000.0));
    const auto mach = reader.find_number("mach", Range::between(1e-6, 1000.0));
    if (reader.has("speed_m_s") && reader.has("mach"))
        reader.error("mach", "and speed_m_s are both given; one of them says it all");
    const bool drawn = reader.has("draw_frequency_Hz");
    if (drawn)
        reader.error("draw_frequency_Hz",
                     "is for paths that are run through again and again; a line "
                     "is run through once: give speed_m_s or mach");
    else if (!reader.has("speed_m_s") && !reader.has("mach"))
        reader.error("speed_m_s", "is missing (or mach, the speed over c_s of the top layer)");
    if (mach) return *mach * (medium.layers.empty() ? 1.0 : medium.layers.front().c_s_m_s);
    return speed_m_s.value_or(1.0);
}

Motion read_motion(Reader& reader, const Medium& medium, std::string_view kind) {
    const std::size_t before = reader.findings().errors();
    const double speed_m_s = read_speed_m_s(reader, medium);
    if (kind != "SM-STM") return ConstantSpeed{speed_m_s};
    const OscillatingSpeed motion = {
        .mean_m_s = speed_m_s,
        .deviation_m_s = reader.number("speed_deviation_m_s", Range::at_least(0.0)),
        .frequency_Hz = reader.number("sm_frequency_Hz", Range::between(1e-3, 1e5)),
        .phase_rad = reader.number_or("sm_phase_deg", 0.0, Range::any()),
    };
    if (reader.findings().errors() == before && reader.has("speed_deviation_m_s") &&
        motion.deviation_m_s >= motion.mean_m_s)
        reader.error("speed_deviation_m_s",
                     fmt::format("must be below the mean speed of {:.6g} m/s, and is {:.6g}: the "
                                 "focus would turn back on its path",
                                 motion.mean_m_s, motion.deviation_m_s));
    return motion;
}

SineGain read_sine(Reader& reader) {
    static const std::array<std::string, 2> quantities = {"force", "pressure"};
    return {
        .frequency_Hz = reader.number("am_frequency_Hz", Range::between(1e-3, 1e5)),
        .depth = reader.number_or("am_depth", 1.0, Range::between(0.0, 1.0)),
        .phase_rad = reader.number_or("am_phase_deg", 0.0, Range::any()),
        .on = reader.choice_or("am_on", "force", quantities) == "force" ? GainOn::force
                                                                        : GainOn::pressure,
    };
}

void settle_other_kinds(Reader& reader, std::string_view kind, OtherKinds other_kinds) {
    for (const KindKey& other : kind_keys) {
        if (holds_word(other.kinds, kind)) continue;
        if (reader.has(other.key) && other_kinds == OtherKinds::refused)
            reader.error(other.key, fmt::format("has no meaning for kind {}", kind));
    }
}

} // namespace

bool has_meaning(std::string_view key, std::string_view kind) {
    for (const KindKey& known : kind_keys)
        if (key == known.key || (key.starts_with(known.key) && key[known.key.size()] == '.'))
            return holds_word(known.kinds, kind);
    return true;
}

Modulation read_modulation(Reader& reader, const Medium& medium, OtherKinds other_kinds) {
    if (reader.empty()) return {};
    Modulation modulation;
    if (!reader.has("kind")) reader.missing("kind");
    const auto kind = reader.find_choice("kind", kinds);
    const auto ramp_s = reader.find_number("ramp_ms", Range::above(0.0));
    if (!kind) { // which keys it should have is anybody's guess
        for (const KindKey& known : kind_keys)
            reader.allow(std::array{known.key});
        reader.finish();
        return modulation;
    }
    modulation.kind = *kind;
    if (*kind == "AM") {
        modulation.trajectory.parts.push_back(Hold{reader.point_or("position_mm", {})});
    } else {
        Travel travel;
        travel.motion = read_motion(reader, medium, *kind);
        read_path(reader.table("path"), travel);
        modulation.trajectory.parts.push_back(travel);
    }
    if (kind->starts_with("AM")) modulation.envelope.gains.push_back(read_sine(reader));
    if (ramp_s) modulation.envelope.gains.push_back(RampGain{*ramp_s});
    settle_other_kinds(reader, *kind, other_kinds);
    reader.finish();
    return modulation;
}

} // namespace shearwake
