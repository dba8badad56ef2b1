#include "config/read_path.hpp"
#include "model/course.hpp"

#include <fmt/format.h>

namespace shearwake {
namespace {

CornerPace read_corners(Reader& reader) {
    return {.dwell_s = reader.number_or("corner_dwell_ms", 0.0, Range::at_least(0.0)),
            .slow_within_m = reader.number_or("corner_slow_mm", 0.0, Range::at_least(0.0)),
            .slow_to = reader.number_or("corner_slow_to", 1.0, Range::between(0.01, 1.0))};
}

void check_corners(Reader& reader, const Travel& travel) {
    const CornerPace& pace = travel.corners;
    const char* key = pace.dwell_s > 0.0 ? "corner_dwell_ms" : "corner_slow_mm";
    if (reader.has("corner_slow_mm") != reader.has("corner_slow_to"))
        reader.error(reader.has("corner_slow_mm") ? "corner_slow_mm" : "corner_slow_to",
                     "is given alone: corner_slow_mm says within which way of a corner, "
                     "corner_slow_to to which share of the speed");
    if (pace == CornerPace{}) return;
    if (std::holds_alternative<OscillatingSpeed>(travel.motion))
        reader.error(key, "and an oscillating speed do not go together");
    else if (stops(travel) == 0)
        reader.error(key, "has no meaning on a path without corners that is not run back and "
                          "forth; a corner turns by 20 degrees or more");
    else if (2.0 * pace.slow_within_m > shortest_between_stops_m(travel) * (1.0 + 1e-12))
        reader.error("corner_slow_mm",
                     fmt::format("must be at most {:.6g}, half of the shortest way between two "
                                 "corners, and is {:.6g}",
                                 500.0 * shortest_between_stops_m(travel),
                                 1e3 * pace.slow_within_m));
}

/// The speed that is given, or 1 m/s and a finding.
double read_speed_m_s(Reader& reader, const PathContext& context, const Travel& travel) {
    const auto speed_m_s = reader.find_number("speed_m_s", Range::between(1e-6, 1000.0));
    const auto mach = reader.find_number("mach", Range::between(1e-6, 1000.0));
    const auto draw_Hz = reader.find_number("draw_frequency_Hz", Range::between(1e-3, 1e5));
    if (reader.has("speed_m_s") && reader.has("mach"))
        reader.error("mach", "and speed_m_s are both given; one of them says it all");
    const bool has_speed = reader.has("speed_m_s") || reader.has("mach");
    if (reader.has("draw_frequency_Hz")) {
        if (has_speed)
            reader.error("draw_frequency_Hz",
                         "and a speed are both given; one of them says it all");
        else if (travel.at_end == AtEnd::off || travel.at_end == AtEnd::hold)
            reader.error("draw_frequency_Hz",
                         "is for paths that are run through again and again: give path.at_end = "
                         "\"repeat\" or \"back-and-forth\", or else speed_m_s or mach");
        else if (draw_Hz) {
            const double found = speed_of_cycle_m_s(travel, 1.0 / *draw_Hz);
            if (found > 0.0) return found;
            reader.error("draw_frequency_Hz",
                         fmt::format("leaves {:.4g} ms for a run, of which the {} corners take "
                                     "{:.4g} ms each",
                                     1e3 / *draw_Hz, stops(travel), 1e3 * travel.corners.dwell_s));
        }
        return 1.0;
    }
    if (!has_speed)
        reader.error("speed_m_s",
                     is_closed(travel.path)
                         ? "is missing (or mach, the speed over c_s of the top layer, "
                           "or draw_frequency_Hz)"
                         : "is missing (or mach, the speed over c_s of the top layer)");
    const auto& layers = context.medium.layers;
    if (mach) return *mach * (layers.empty() ? 1.0 : layers.front().c_s_m_s);
    return speed_m_s.value_or(1.0);
}

OscillatingSpeed read_oscillation(Reader& reader, double mean_m_s, bool sound) {
    const OscillatingSpeed motion = {
        .mean_m_s = mean_m_s,
        .deviation_m_s = reader.number("speed_deviation_m_s", Range::at_least(0.0)),
        .frequency_Hz = reader.number("sm_frequency_Hz", Range::between(1e-3, 1e5)),
        .phase_rad = reader.number_or("sm_phase_deg", 0.0, Range::any()),
    };
    if (sound && reader.has("speed_deviation_m_s") && motion.deviation_m_s >= motion.mean_m_s)
        reader.error("speed_deviation_m_s",
                     fmt::format("must be below the mean speed of {:.6g} m/s, and is {:.6g}: the "
                                 "focus would turn back on its path",
                                 motion.mean_m_s, motion.deviation_m_s));
    return motion;
}

} // namespace

Travel read_travel(Reader& reader, const PathContext& context, SpeedKind speed) {
    const std::size_t before = reader.findings().errors();
    const PathAndEnd read = read_path(reader.table("path"), context);
    const bool has_path = reader.has("path") && reader.findings().errors() == before;
    Travel travel{.path = read.path, .at_end = read.at_end};
    const bool oscillates = speed == SpeedKind::oscillating ||
                            (speed == SpeedKind::either &&
                             (reader.has("speed_deviation_m_s") || reader.has("sm_frequency_Hz")));
    const bool takes_corners = speed != SpeedKind::oscillating;
    if (takes_corners) travel.corners = read_corners(reader);
    const std::size_t before_speed = reader.findings().errors();
    const double speed_m_s = read_speed_m_s(reader, context, travel);
    const bool speed_is_sound = reader.findings().errors() == before_speed;
    travel.motion = ConstantSpeed{speed_m_s};
    if (oscillates) travel.motion = read_oscillation(reader, speed_m_s, speed_is_sound);
    if (speed == SpeedKind::either) reader.has("sm_phase_deg");
    if (takes_corners && has_path) check_corners(reader, travel);
    return travel;
}

} // namespace shearwake
