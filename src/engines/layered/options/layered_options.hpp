// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"

#include <optional>

namespace shearwake {

/// Engine `layered`: exact for stratified media.
struct LayeredOptions {
    static constexpr const char* name = "layered";
    std::optional<double> time_step_s; // sampling of the load; none: chosen from its bandwidth
    double window_factor = 2.0;        // period of the time transform, divided by the duration
    double wrap_suppression = 1e6;     // attenuation of signals that wrap around in time
    double interpolation_tolerance =
        1e-9; // of the transfer function H in |k|, relative to nearby values
    bool operator==(const LayeredOptions&) const = default;
};

template <class Walk, Is<LayeredOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk(o.time_step_s,
         {.key = "time_step_us",
          .range = Range::at_least(0.01),
          .fallback = "from the bandwidth and the jumps of the load and from the medium",
          .meaning = "time between samples of the load"});
    walk(o.window_factor, {.key = "window_factor",
                           .range = Range::between(1.25, 16.0),
                           .meaning = "period of the time transform, divided by the duration"});
    walk(o.wrap_suppression,
         {.key = "wrap_suppression",
          .range = Range::between(10.0, 1e8),
          .meaning = "factor by which signals that wrap around in time are attenuated"});
    walk(o.interpolation_tolerance,
         {.key = "interpolation_tolerance",
          .range = Range::between(1e-12, 1e-3),
          .meaning = "relative error of the interpolation of the transfer function H in |k|"});
}

} // namespace shearwake
