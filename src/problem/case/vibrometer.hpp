// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"
#include "base/vectors.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace shearwake {

/// A scanning laser Doppler vibrometer, which measures the velocity of points of the skin along its
/// line of sight, one point after the other.
struct VibrometerOptions {
    std::vector<Vec2> points_m;
    double tilt_rad = 0.0;                     // of the line of sight from the normal of the skin
    double azimuth_rad = 0.0;                  // direction of the tilt, from x towards y
    double offset_x_m = 0.0, offset_y_m = 0.0; // true minus nominal positions
    double spot_m = 0.0;                       // diameter over which the motion is averaged
    double rate_Hz = 0.0;                      // samples per second; 0: one per frame
    double high_pass_Hz = 0.0, low_pass_Hz = 0.0; // 0: none
    double noise_m_s_rtHz = 0.0;                  // one-sided density
    int averages = 1;
    double trigger_delay_s = 0.0; // from the start of the load to the first sample
    double missing_share = 0.0;   // of the points, without signal
    std::ptrdiff_t seed = 1;
    bool operator==(const VibrometerOptions&) const = default;

    /// The direction from the vibrometer to the skin; velocities along it are positive.
    Vec3 line_of_sight() const {
        return {std::sin(tilt_rad) * std::cos(azimuth_rad),
                std::sin(tilt_rad) * std::sin(azimuth_rad), std::cos(tilt_rad)};
    }
    bool is_tilted() const { return tilt_rad != 0.0; }
};

/// The keys from which config derives the points of a scan.
template <class Walk>
void walk_scan_keys(Walk& walk) {
    walk.key({.key = "grid_mm",
              .range = Range::above(0.0),
              .type = "point",
              .fallback = "one of the scans is required",
              .meaning = "scan: size `[x, y]` of a rectangle"});
    walk.key({.key = "polygon_mm",
              .type = "points",
              .fallback = "one of the scans is required",
              .meaning = "scan: corners `[[x, y], ...]` of an area"});
    walk.key({.key = "line_mm",
              .type = "points",
              .fallback = "one of the scans is required",
              .meaning = "scan: start and end `[[x, y], [x, y]]` of a line"});
    walk.key({.key = "file",
              .type = "file",
              .fallback = "one of the scans is required",
              .meaning = "scan: CSV file with the header `x_mm,y_mm` and one point per line; its "
                         "path is relative to the job file"});
    walk.key({.key = "spacing_mm",
              .range = Range::above(0.0),
              .type = "number",
              .fallback = "required unless the points are listed",
              .meaning = "distance of neighbouring points of a grid, area or line"});
    walk.key({.key = "center_mm",
              .type = "point",
              .fallback = "[0, 0]",
              .meaning = "with `grid_mm`: its centre"});
}

/// From the motion along the line of sight to the recorded samples.
template <class Walk, Is<VibrometerOptions> Options>
void walk_signal_fields(Walk& walk, Options& o) {
    walk(o.rate_Hz, {.key = "sampling_rate_kHz",
                     .range = Range::between(0.01, 10000.0),
                     .fallback = "one sample per frame",
                     .meaning = "sampling rate"});
    walk(o.high_pass_Hz, {.key = "high_pass_Hz",
                          .range = Range::between(0.1, 1e6),
                          .fallback = "none",
                          .meaning = "cutoff of the high-pass filter (Butterworth, second order)"});
    walk(o.low_pass_Hz, {.key = "low_pass_Hz",
                         .range = Range::between(0.1, 1e7),
                         .fallback = "none",
                         .meaning = "cutoff of the low-pass filter (Butterworth, second order)"});
    walk(o.noise_m_s_rtHz, {.key = "noise_um_s_rtHz",
                            .text = "noise_m_s_rtHz",
                            .range = Range::between(0.0, 1e6),
                            .given = Given::by_hand,
                            .fallback = "0",
                            .meaning = "one-sided density of the noise of the velocity, in um/s "
                                       "per square root of Hz"});
    walk(o.averages, {.key = "averages",
                      .range = Range::between(1, 1000000),
                      .meaning = "number of repetitions that are averaged at each point"});
    walk(o.trigger_delay_s, {.key = "trigger_delay_ms",
                             .range = Range::between(-1e5, 1e5),
                             .meaning = "time from the start of the load to the first sample; "
                                        "negative: the recording begins earlier"});
    walk(o.missing_share, {.key = "missing_percent",
                           .text = "missing_share",
                           .range = Range::between(0.0, 99.0),
                           .given = Given::by_hand,
                           .fallback = "0",
                           .meaning = "percentage of the points, chosen at random, that return no "
                                      "signal"});
    walk(o.seed, {.key = "seed",
                  .range = Range::between(0, 1000000000),
                  .meaning = "seed of the noise and of the missing points"});
}

template <class Walk, Is<VibrometerOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk_scan_keys(walk);
    walk(o.points_m, {.key = "points_mm",
                      .text = "points_{}_m",
                      .given = Given::by_hand,
                      .most_in_text = 100,
                      .fallback = "one of the scans is required",
                      .meaning = "scan: list of points `[[x, y], ...]`"});
    walk(o.tilt_rad, {.key = "tilt_deg",
                      .range = Range::between(0.0, 80.0),
                      .meaning = "angle between the line of sight and the normal of the skin; not "
                                 "0: engine `\"layered\"` with periodic edges"});
    walk(o.azimuth_rad, {.key = "azimuth_deg",
                         .meaning = "direction along the skin in which a tilted line of sight "
                                    "points, from x towards y"});
    walk(o.offset_x_m, {.key = "offset_x_mm",
                        .range = Range::between(-1000.0, 1000.0),
                        .meaning = "misalignment along x: true minus stated positions of the "
                                   "points"});
    walk(o.offset_y_m, {.key = "offset_y_mm",
                        .range = Range::between(-1000.0, 1000.0),
                        .meaning = "misalignment along y"});
    walk(o.spot_m, {.key = "spot_um",
                    .range = Range::between(0.0, 20000.0),
                    .meaning = "diameter of the laser spot, over which the motion is averaged"});
    walk_signal_fields(walk, o);
}

} // namespace shearwake
