// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_fields.hpp"
#include "config/sections/read_path.hpp"
#include "problem/load/motion/trajectory.hpp"

#include <fmt/format.h>

namespace shearwake::config {
namespace {

CornerPace read_corners(Reader& reader) {
    CornerPace pace;
    read_fields(reader, pace);
    return pace;
}

void check_corners(Reader& reader, const Travel& travel) {
    const CornerPace& pace = travel.corners;
    const char* key = pace.dwell_s > 0.0 ? "corner_dwell_ms" : "corner_slow_mm";
    if (reader.has("corner_slow_mm") != reader.has("corner_slow_to"))
        reader.error(reader.has("corner_slow_mm") ? "corner_slow_mm" : "corner_slow_to",
                     "requires the other of corner_slow_mm (distance over which the focus slows "
                     "down) and corner_slow_to (fraction of its speed at the corner)");
    if (pace == CornerPace{}) return;
    if (std::holds_alternative<OscillatingSpeed>(travel.motion))
        reader.error(key, "cannot be combined with an oscillating speed");
    else if (stops(travel) == 0)
        reader.error(key, "does not apply to a path that has no corners and is not traversed back "
                          "and forth; a corner turns by 20 degrees or more");
    else if (2.0 * pace.slow_within_m > shortest_between_stops_m(travel) * (1.0 + 1e-12))
        reader.error("corner_slow_mm",
                     fmt::format("must be at most {:.6g}, half of the shortest distance between "
                                 "two corners along the path, but is {:.6g}",
                                 500.0 * shortest_between_stops_m(travel),
                                 1e3 * pace.slow_within_m));
}

/// The given speed, or 1 m/s and a diagnostic. Without a valid path, a frequency is not checked
/// against it.
double read_speed_m_s(Reader& reader, const PathContext& context, const Travel& travel,
                      bool has_path) {
    const auto speed_m_s = reader.find_number("speed_m_s", range_of<Travel>("speed_m_s"));
    const auto mach = reader.find_number("mach", range_of<Travel>("mach"));
    const auto draw_Hz =
        reader.find_number("draw_frequency_Hz", range_of<Travel>("draw_frequency_Hz"));
    if (reader.has("speed_m_s") && reader.has("mach"))
        reader.conflict("mach", "and speed_m_s are both given; remove one of them from the job");
    const bool has_speed = reader.has("speed_m_s") || reader.has("mach");
    if (reader.has("draw_frequency_Hz")) {
        if (has_speed)
            reader.conflict("draw_frequency_Hz",
                            "and a speed are both given; remove one of them from the job");
        else if (!has_path)
            return 1.0;
        else if (travel.at_end == AtEnd::off || travel.at_end == AtEnd::hold)
            reader.error("draw_frequency_Hz",
                         "requires a path that repeats: set path.at_end = \"repeat\" or "
                         "\"back-and-forth\", or give speed_m_s or mach instead");
        else if (draw_Hz) {
            const double found = speed_of_cycle_m_s(travel, 1.0 / *draw_Hz);
            if (found > 0.0) return found;
            reader.error("draw_frequency_Hz",
                         fmt::format("leaves {:.4g} ms per pass along the path, but the {} corners "
                                     "take {:.4g} ms each",
                                     1e3 / *draw_Hz, stops(travel), 1e3 * travel.corners.dwell_s));
        }
        return 1.0;
    }
    const bool is_misspelled = reader.has_misspelled("speed_m_s") ||
                               reader.has_misspelled("draw_frequency_Hz"); // reported by finish()
    // A file that cannot be read may state the time at each point.
    const bool may_rest = !has_path && reader.optional_table("path").has("file");
    if (!has_speed && !is_misspelled && !may_rest)
        reader.error("speed_m_s",
                     is_closed(travel.path)
                         ? "is missing (or mach, the speed divided by c_s of the top layer, or "
                           "draw_frequency_Hz)"
                         : "is missing (or mach, the speed divided by c_s of the top layer)");
    const auto& layers = context.medium.layers;
    if (mach) return *mach * (layers.empty() ? 1.0 : layers.front().c_s_m_s);
    return speed_m_s.value_or(1.0);
}

OscillatingSpeed read_oscillation(Reader& reader, double mean_m_s, bool sound) {
    OscillatingSpeed motion = {.mean_m_s = mean_m_s};
    read_fields(reader, motion);
    if (sound && reader.has("speed_deviation_m_s") && motion.deviation_m_s >= motion.mean_m_s)
        reader.error("speed_deviation_m_s",
                     fmt::format("must be below the mean speed of {:.6g} m/s, but is {:.6g}: the "
                                 "focus would move backwards along its path",
                                 motion.mean_m_s, motion.deviation_m_s));
    return motion;
}

} // namespace

Travel read_travel(Reader& reader, const PathContext& context, SpeedKind speed) {
    const std::size_t before = reader.diagnostics().errors();
    const PathAndEnd read = read_path(reader.table("path"), context);
    const bool has_path = reader.has("path") && reader.diagnostics().errors() == before;
    Travel travel{.path = read.path, .at_end = read.at_end};
    const bool oscillates = speed == SpeedKind::oscillating ||
                            (speed == SpeedKind::either &&
                             (reader.has("speed_deviation_m_s") || reader.has("sm_frequency_Hz")));
    if (read.rests) {
        for (const char* key : {"speed_m_s", "mach", "draw_frequency_Hz", "corner_dwell_ms",
                                "corner_slow_mm", "corner_slow_to"})
            if (reader.has(key))
                reader.error(key, "does not apply, since the file of the path states the time at "
                                  "each point");
        if (oscillates)
            reader.error("path", "has a file with the time at each point, which cannot be combined "
                                 "with an oscillating speed");
        travel.motion = *read.rests;
        return travel;
    }
    const bool has_corners = speed != SpeedKind::oscillating;
    if (has_corners) travel.corners = read_corners(reader);
    const std::size_t before_speed = reader.diagnostics().errors();
    const double speed_m_s = read_speed_m_s(reader, context, travel, has_path);
    const bool speed_is_sound = reader.diagnostics().errors() == before_speed;
    travel.motion = ConstantSpeed{speed_m_s};
    if (oscillates) travel.motion = read_oscillation(reader, speed_m_s, speed_is_sound);
    if (speed == SpeedKind::either) reader.has("sm_phase_deg");
    if (has_corners && has_path) check_corners(reader, travel);
    return travel;
}

} // namespace shearwake::config
