// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/study_run.hpp"

#include "base/error.hpp"
#include "engines/pstd/estimate.hpp"
#include "engines/pstd/pstd_march.hpp"
#include "engines/pstd/study_limits.hpp"
#include "engines/pstd/study_material.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

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

Setup setup_of(const StudyData& study) {
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

/// Number of steps per frame interval.
std::ptrdiff_t steps_of_a_frame(const Case& c) {
    return std::llround(c.time.interval_s / study_of(c).time_step_s);
}

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

template <class Real>
void run_with(const Case& c, const Comm& team, engines::Observer& observer,
              engines::Checkpoints* checkpoints) {
    const StudyData& study = study_of(c);
    Stepper<Real> stepper(setup_of(study), team);
    std::optional<typename PstdMarch<Real>::Outputs> outputs;
    together(team, [&] {
        outputs.emplace(
            typename PstdMarch<Real>::Outputs{.frames = Frames(c, frame_places(c), stepper.slabs()),
                                              .volumes = {},
                                              .sensor = Sensor(study, stepper.slabs())});
    });
    observer.begin(outputs->frames.slab());
    PstdMarch<Real> field(c, steps_of_a_frame(c), stepper, *outputs, "u_z", team);
    if (engines::march(field, study.steps, observer, checkpoints) == engines::MarchEnd::stopped)
        return;
    observer.solved({.notes = {fmt::format("grid study {}: {} x {} x {} nodes", study.content_hash,
                                           study.points[0], study.points[1], study.points[2])},
                     .steps = stepper.steps(),
                     .sensors = outputs->sensor->series(team)});
}

} // namespace

engines::Estimate estimate_study(const Case& c, int ranks) {
    const StudyData& study = study_of(c);
    const auto points = static_cast<double>(study.size());
    engines::Estimate e =
        estimate_steps({.points = points,
                        .steps = static_cast<double>(study.steps),
                        .absorption = study.lossy() ? Absorption::kelvin_voigt : Absorption::none,
                        .precision = std::get<PstdOptions>(c.solver).precision,
                        .uneven = is_uneven(study),
                        .ranks = ranks});
    e.work.push_back(work_of_frames(c));
    double stored = 0.0;
    for (const auto* values :
         {&study.density_kg_m3, &study.c_p_m_s, &study.c_s_m_s, &study.chi_Pa_s, &study.eta_Pa_s})
        stored += static_cast<double>(values->size());
    for (const NodeSource& source : study.sources)
        stored += static_cast<double>(source.series.size() + 5 * source.nodes.size());
    const double recorded = static_cast<double>(study.sensors.size() * study.sensor_fields.size()) *
                            static_cast<double>(study.steps - study.sensor_start + 1);
    e.written_B = 8.0 * recorded;
    e.memory_per_rank_B += 8.0 * (stored + 2.0 * recorded);
    e.work.push_back(
        {engines::of_fresh_memory, ranks * (e.memory_per_rank_B - engines::program_B)});
    e.useful_ranks = static_cast<int>(std::min(study.points[0], study.points[1]));
    return e;
}

void run_study(const Case& c, const Comm& team, engines::Observer& observer,
               engines::Checkpoints* checkpoints) {
    if (const std::string trouble = study_trouble(c); !trouble.empty()) throw CaseFailure(trouble);
    if (std::get<PstdOptions>(c.solver).precision == Precision::single_precision)
        run_with<float>(c, team, observer, checkpoints);
    else
        run_with<double>(c, team, observer, checkpoints);
}

} // namespace shearwake::pstd
