// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/study_limits.hpp"

#include "engines/pstd/scene/case_step.hpp"
#include "engines/pstd/study_material.hpp"

#include <cmath>
#include <fmt/format.h>

namespace shearwake::pstd {
namespace {

/// Extremes of the materials of all nodes.
Extremes extremes_of(const StudyData& study, double spacing_m) {
    const MaterialOfNode material = material_of(study);
    const auto points = is_uneven(study) ? study.points : std::array<std::ptrdiff_t, 3>{1, 1, 1};
    Extremes extremes;
    NodeMaterial last; // most neighbours along z are equal
    for (std::ptrdiff_t x = 0; x < points[0]; ++x)
        for (std::ptrdiff_t y = 0; y < points[1]; ++y)
            for (std::ptrdiff_t z = 0; z < points[2]; ++z)
                if (const NodeMaterial here = material({x, y, z}); here != last) {
                    extremes.add(here, spacing_m);
                    last = here;
                }
    return extremes;
}

} // namespace

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

std::vector<Remark> study_step_remarks(const StudyData& study) {
    // The spacing of cubic cells with the same largest wave number. An odd number of points has no
    // wave of two points.
    double inverse_m2 = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto points = static_cast<double>(study.points[axis]);
        const double share = study.points[axis] % 2 == 1 ? 1.0 - 1.0 / points : 1.0;
        inverse_m2 += std::pow(share / study.spacing_m[axis], 2);
    }
    const double spacing_m = std::sqrt(3.0 / inverse_m2);
    const Extremes extremes = extremes_of(study, spacing_m);
    const double safe_s = safe_step_s(extremes, spacing_m), step_s = study.time_step_s;
    if (step_s <= safe_s) return {};
    const bool unstable = step_s > extremes.alone_s;
    return {{unstable ? Severity::error : Severity::warning, "solver.pstd.study",
             fmt::format("has a time step of {:.6g} us (kgrid.dt in k-Wave), which {} unstable in "
                         "this medium: steps up to {:.6g} us are stable, steps above {:.6g} us are "
                         "unstable; reduce kgrid.dt and import the simulation again",
                         1e6 * step_s, unstable ? "is" : "may be", 1e6 * safe_s,
                         1e6 * extremes.alone_s)}};
}

} // namespace shearwake::pstd
