// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/study_run.hpp"

#include "base/error.hpp"
#include "engines/pstd/pstd_engine.hpp"
#include "engines/pstd/scene/case_step.hpp"
#include "engines/pstd/scheme/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::pstd {

namespace {

const StudyData& study_of(const Case& c) {
    return *c.study();
}

Source source_of(const NodeSource& given) {
    Source source{.field = static_cast<Field>(given.field),
                  .mode = given.dirichlet ? SourceMode::dirichlet : SourceMode::additive,
                  .scaling = SourceScaling::none,
                  .nodes = given.nodes,
                  .samples = given.samples};
    source.values = [&given](std::ptrdiff_t sample, std::span<const std::size_t> which,
                             std::span<double> values) {
        for (std::size_t i = 0; i < which.size(); ++i)
            values[i] =
                given.weights[which[i]] *
                given.series[given.rows[which[i]] * static_cast<std::size_t>(given.samples) +
                             static_cast<std::size_t>(sample)];
    };
    return source;
}

} // namespace

Setup study_setup(const StudyData& study) {
    Setup setup;
    setup.grid = {study.points, study.spacing_m, study.time_step_s};
    setup.pml = {.points = study.layer_points,
                 .strength_1 = study.layer_strength,
                 .multi_axial_ratio_1 = study.layer_ratio,
                 .reference_speed_m_s = study.layer_speed_m_s};
    setup.material = material_of(study);
    setup.absorption = study.lossy() ? Absorption::kelvin_voigt : Absorption::none;
    for (const NodeSource& source : study.sources)
        setup.sources.push_back(source_of(source));
    return setup;
}

std::set<std::string> records_of(const StudyData& study) {
    std::set<std::string> names;
    for (const std::size_t record : study.sensor_fields)
        names.insert(sensor_records[record].name);
    return names;
}

namespace {

/// The domain in the middle of the grid; linear interpolation between the two planes around a
/// depth.
FramePlaces frame_places(const Case& c) {
    const StudyData& study = study_of(c);
    std::vector<double> places;
    for (const double depth_m : c.measure.depths_m)
        places.push_back(std::clamp(depth_m / study.spacing_m[2] - 0.5, 0.0,
                                    static_cast<double>(study.points[2] - 1)));
    const auto [low, high] = std::minmax_element(places.begin(), places.end());
    FramePlaces frames{.first_x = study.points[0] / 2 - c.domain.nx / 2,
                       .first_y = study.points[1] / 2 - c.domain.ny / 2,
                       .first_z = static_cast<std::ptrdiff_t>(std::floor(*low + 1e-9))};
    frames.planes = static_cast<std::ptrdiff_t>(std::ceil(*high - 1e-9)) - frames.first_z + 1;
    for (const double place : places) {
        std::vector<double> weights(static_cast<std::size_t>(frames.planes), 0.0);
        const auto above = static_cast<std::ptrdiff_t>(std::floor(place + 1e-9));
        const auto at = static_cast<std::size_t>(above - frames.first_z);
        const double share = std::max(place - static_cast<double>(above), 0.0);
        weights[at] = 1.0 - share;
        if (share > 1e-9) weights[at + 1] = share;
        frames.weights.push_back(std::move(weights));
    }
    return frames;
}

PstdPlan plan_of(const Case& c) {
    const StudyData& study = study_of(c);
    const auto varies = [](const std::vector<double>& values) { return values.size() > 1; };
    const Setup setup = study_setup(study);
    double nodes = 0.0;
    for (const NodeSource& source : study.sources)
        nodes += static_cast<double>(source.nodes.size());
    return {.grid = setup.grid,
            .pml = setup.pml,
            .steps = static_cast<double>(study.steps),
            .absorption = setup.absorption,
            .precision = std::get<PstdOptions>(c.solver).precision,
            .uneven = is_uneven(study),
            .coefficients = varying_coefficients(
                varies(study.density_kg_m3), varies(study.c_p_m_s) || varies(study.c_s_m_s),
                varies(study.chi_Pa_s) || varies(study.eta_Pa_s), setup.absorption),
            .source_nodes = nodes,
            .places = frame_places(c),
            .per_frame = std::llround(c.time.interval_s / study.time_step_s)};
}

} // namespace

std::vector<std::string> study_notes(const Case& c) {
    return {fmt::format("grid study {}", study_of(c).content_hash), note_of(plan_of(c))};
}

engines::Resources study_resources(const Case& c, int ranks) {
    const StudyData& study = study_of(c);
    double stored = 0.0;
    for (const auto* values :
         {&study.density_kg_m3, &study.c_p_m_s, &study.c_s_m_s, &study.chi_Pa_s, &study.eta_Pa_s})
        stored += static_cast<double>(values->size());
    for (const NodeSource& source : study.sources)
        stored += static_cast<double>(source.series.size() + 5 * source.nodes.size());
    const std::ptrdiff_t samples = study.steps - study.sensor_start + 1;
    const std::set<std::string> records = records_of(study);
    const Grid grid{study.points, study.spacing_m, study.time_step_s};
    const double recorded = Recorder::output_values(study.sensor, grid, records, samples);
    engines::Resources all = resources_of(c, plan_of(c), ranks);
    all.written_B = 8.0 * recorded;
    all.arrays.push_back({"study", 8.0 * stored});
    // Rank 0 gathers the results.
    all.arrays.push_back(
        {"records of the sensor", Recorder::memory_B(study.sensor, grid, records, samples, ranks) +
                                      sizeof(double) * recorded});
    return all;
}

void run_study(const Case& c, const Comm& team, engines::Observer& observer,
               engines::Checkpoints* checkpoints) {
    if (const std::string reason = study_error(c); !reason.empty()) throw CaseFailure(reason);
    run_plan(c, plan_of(c),
             {.setup = [&] { return study_setup(study_of(c)); },
              .grid = nullptr,
              .report = {.notes = study_notes(c)}},
             team, observer, checkpoints);
}

MaterialOfNode material_of(const StudyData& study) {
    return [&study](Node node) {
        const std::ptrdiff_t at = (node[0] * study.points[1] + node[1]) * study.points[2] + node[2];
        const auto value = [&](const std::vector<double>& values) {
            if (values.empty()) return 0.0;
            return values.size() == 1 ? values[0] : values[static_cast<std::size_t>(at)];
        };
        return NodeMaterial{value(study.density_kg_m3), value(study.c_p_m_s), value(study.c_s_m_s),
                            value(study.chi_Pa_s), value(study.eta_Pa_s)};
    };
}

bool is_uneven(const StudyData& study) {
    return std::max({study.density_kg_m3.size(), study.c_p_m_s.size(), study.c_s_m_s.size(),
                     study.eta_Pa_s.size(), study.chi_Pa_s.size()}) > 1;
}

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

std::string study_error(const Case& c) {
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
    const double spacing_m = cubic_spacing_m({study.points, study.spacing_m});
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
