// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/study_limits.hpp"

#include <cmath>
#include <fmt/format.h>

namespace shearwake::pstd {

std::string study_trouble(const Case& c) {
    if (!c.study()) return "";
    const StudyData& study = *c.study();
    const double d_m = c.domain.spacing_m;
    for (const std::size_t axis : {0u, 1u}) {
        if (std::abs(study.spacing_m[axis] - d_m) > 1e-9 * d_m)
            return fmt::format(
                "domain.spacing_mm is {:.9g}, but the spacing of the study along {} is {:.9g}",
                1e3 * d_m, "xy"[axis], 1e3 * study.spacing_m[axis]);
        const std::ptrdiff_t points = axis == 0 ? c.domain.nx : c.domain.ny;
        if (points > study.points[axis])
            return fmt::format(
                "domain.extent_mm results in {} points along {}, but the study has {}", points,
                "xy"[axis], study.points[axis]);
    }
    const double ratio = c.time.interval_s / study.time_step_s;
    if (std::round(ratio) < 1.0 || std::abs(ratio - std::round(ratio)) > 1e-6 * ratio)
        return fmt::format(
            "time.output_interval_us must be a multiple of the time step of the study, {:.9g}",
            1e6 * study.time_step_s);
    if (c.time.frames * std::llround(ratio) > study.steps)
        return fmt::format("time.duration_ms exceeds the duration of the study, {:.9g}",
                           1e3 * study.time_step_s * static_cast<double>(study.steps));
    const double deepest_m = static_cast<double>(study.points[2]) * study.spacing_m[2];
    for (const double depth_m : c.measure.depths_m)
        if (depth_m > deepest_m)
            return fmt::format("measure.depths_mm contains {:.9g}, but the study ends at {:.9g}",
                               1e3 * depth_m, 1e3 * deepest_m);
    if (!c.scene().medium.bodies.empty() || c.scene().medium.map)
        return "bodies and medium.map have no effect with a study, whose file contains the medium";
    if (!c.record.volumes_s.empty())
        return "record.volumes_ms is not supported for studies; use a sensor that covers a cuboid";
    return "";
}

} // namespace shearwake::pstd
