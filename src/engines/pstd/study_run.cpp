#include "engines/pstd/study_run.hpp"

#include "base/error.hpp"
#include "engines/pstd/estimate.hpp"
#include "engines/pstd/frames.hpp"
#include "engines/pstd/sensor.hpp"
#include "model/check_study.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace shearwake::pstd {
namespace {

const GridStudy& study_of(const Case& c) {
    return *std::get<PstdOptions>(c.solver).study;
}

MaterialOfNode material_of(const GridStudy& study) {
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

Setup setup_of(const GridStudy& study) {
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

/// Steps in an interval of frames.
std::ptrdiff_t steps_of_a_frame(const Case& c) {
    return std::llround(c.time.interval_s / study_of(c).time_step_s);
}

/// The domain in the middle of the grid; depths linear between the two planes around them.
FramePlaces frame_places(const Case& c) {
    const GridStudy& study = study_of(c);
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
void run_with(const Case& c, const Comm& team, Observer& observer, Checkpoints* checkpoints) {
    const GridStudy& study = study_of(c);
    Stepper<Real> stepper(setup_of(study), team);
    std::optional<Frames> frames;
    std::optional<Sensor> sensor;
    together(team, [&] {
        frames.emplace(c, frame_places(c), stepper.slabs());
        sensor.emplace(study, stepper.slabs());
    });
    observer.begin(frames->slab());
    if (checkpoints)
        checkpoints->restore([&](StateReader& state) {
            stepper.restore(state);
            frames->displacement().restore(state, "u_z");
            sensor->restore(state);
            observer.restore(state);
        });
    const std::ptrdiff_t per_frame = steps_of_a_frame(c);
    while (stepper.steps() < study.steps) {
        stepper.step();
        frames->displacement().add(stepper);
        sensor->add(stepper);
        const std::ptrdiff_t frame = stepper.steps() / per_frame - 1;
        if (stepper.steps() % per_frame == 0 && frame < c.time.frames)
            frames->give(frame, observer, team);
        if (!checkpoints || stepper.steps() == study.steps || !checkpoints->due()) continue;
        checkpoints->save([&](StateWriter& state) {
            stepper.save(state);
            frames->displacement().save(state, "u_z");
            sensor->save(state);
            observer.save(state);
        });
        if (checkpoints->stop()) return;
    }
    observer.solved({.notes = {fmt::format("grid study {}: {} x {} x {} nodes", study.content_hash,
                                           study.points[0], study.points[1], study.points[2])},
                     .steps = stepper.steps(),
                     .sensors = sensor->series(team)});
}

} // namespace

Estimate estimate_study(const Case& c, int ranks) {
    const GridStudy& study = study_of(c);
    const auto points = static_cast<double>(study.size());
    const bool single = std::get<PstdOptions>(c.solver).precision == Precision::single_precision;
    Estimate e = estimate_steps({points, static_cast<double>(study.steps), study.lossy(), single});
    double held = 0.0;
    for (const auto* values :
         {&study.density_kg_m3, &study.c_p_m_s, &study.c_s_m_s, &study.chi_Pa_s, &study.eta_Pa_s})
        held += static_cast<double>(values->size());
    for (const NodeSource& source : study.sources)
        held += static_cast<double>(source.series.size() + 5 * source.nodes.size());
    e.memory_per_rank_B =
        60e6 + 8.0 * held + (single ? 4.0 : 8.0) * (study.lossy() ? 52.0 : 38.0) * points / ranks;
    e.useful_ranks = static_cast<int>(std::min(study.points[0], study.points[1]));
    return e;
}

void run_study(const Case& c, const Comm& team, Observer& observer, Checkpoints* checkpoints) {
    if (const std::string trouble = study_trouble(c); !trouble.empty()) throw CaseFailure(trouble);
    if (std::get<PstdOptions>(c.solver).precision == Precision::single_precision)
        run_with<float>(c, team, observer, checkpoints);
    else
        run_with<double>(c, team, observer, checkpoints);
}

} // namespace shearwake::pstd
