// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/pstd_engine.hpp"

#include "base/error.hpp"
#include "engines/pstd/pstd_march.hpp"
#include "engines/pstd/scene/case_load.hpp"
#include "engines/pstd/scene/case_step.hpp"
#include "engines/pstd/scheme/stepper.hpp"
#include "engines/pstd/study_run.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace shearwake::pstd {
namespace {

Setup setup_of(const Case& c, const PstdOptions& options, const CaseGrid& grid,
               const PstdPlan& plan) {
    Setup setup;
    setup.grid = plan.grid;
    setup.pml = plan.pml;
    setup.material = [=, &c](Node node) { return material_at(c, options, grid, node); };
    setup.staggered = staggered_material(c, options, grid);
    setup.absorption = plan.absorption;
    setup.sources.push_back(load_source(c, options, grid, plan.grid.dt_s));
    return setup;
}

FramePlaces frame_places(const Case& c, const PstdOptions& options, const CaseGrid& grid) {
    const SurfacePlane surface =
        options.top == PstdTop::nothing && options.load == PstdLoad::traction
            ? SurfacePlane::rings
            : SurfacePlane::accurate;
    FramePlaces places{
        .first_x = grid.first_x, .first_y = grid.first_y, .first_z = grid.surface - 1};
    if (!c.record.volumes_s.empty()) places.planes = grid.levels;
    for (const double depth_m : c.measure.depths_m) {
        places.weights.push_back(depth_weights(depth_m, grid.spacing_m, surface));
        places.planes = std::max(places.planes, std::ssize(places.weights.back()));
    }
    return places;
}

/// Whether some body, or the map, has a property of its own.
template <class Of>
bool varies(const Medium& medium, Of Body::*of_body, std::vector<double> MaterialMap::*of_map) {
    return std::ranges::any_of(medium.bodies,
                               [&](const Body& b) { return (b.*of_body).has_value(); }) ||
           (medium.map && !((*medium.map).*of_map).empty());
}

PstdPlan plan_of(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                 std::ptrdiff_t per_frame, int ranks) {
    const double d_m = c.domain.spacing_m;
    const Medium& medium = c.scene().medium;
    const Absorption absorption = is_lossy(medium) ? Absorption::kelvin_voigt : Absorption::none;
    const Grid nodes{
        grid.points, {d_m, d_m, d_m}, c.time.interval_s / static_cast<double>(per_frame)};
    const Slabs slabs = slabs_of(nodes, ranks, ranks - 1);
    const double displacements = static_cast<double>(
        frame_places(c, options, grid).planes + (c.record.volumes_s.empty() ? 0 : 2 * grid.levels));
    return {.grid = nodes,
            .pml = absorbing_layer(c, options),
            .steps = static_cast<double>(c.time.frames * per_frame),
            .absorption = absorption,
            .precision = options.precision,
            .uneven = varies_laterally(medium),
            .coefficients = varying_coefficients(
                varies(medium, &Body::density_kg_m3, &MaterialMap::density_kg_m3),
                varies(medium, &Body::c_s_m_s, &MaterialMap::c_s_m_s) ||
                    varies(medium, &Body::c_p_m_s, &MaterialMap::c_p_m_s),
                varies(medium, &Body::viscosity_Pa_s, &MaterialMap::viscosity_Pa_s), absorption),
            .source_nodes = most_source_nodes(c, options),
            .output_B = displacements * sizeof(double) * static_cast<double>(slabs.rows())};
}

/// With snapshots, every step adds to the displacements of all points.
engines::MarchWork case_work(const Case& c, const CaseGrid& grid, const PstdPlan& plan) {
    engines::MarchWork work = march_work(c, plan);
    if (c.record.volumes_s.empty()) return work;
    work.kind += ", displacements";
    work.values = 3.0 * static_cast<double>(c.domain.nx * c.domain.ny * grid.levels);
    work.snapshots = static_cast<double>(c.record.volumes_s.size());
    return work;
}

std::vector<std::string> notes_of_case(const Case& c, const StepChoice& step,
                                       const PstdPlan& plan) {
    auto notes = engines::notes_of(choices(c, std::get<PstdOptions>(c.solver), step));
    notes.push_back(note_of(plan));
    return notes;
}

template <class Real>
void run_with(const Case& c, const PstdOptions& options, const Comm& team,
              engines::Observer& observer, engines::Checkpoints* checkpoints) {
    const auto began = Clock::now();
    const CaseGrid grid = case_grid(c, options);
    const StepChoice step = choose_step(c, options, extremes_of_grid(c, options, grid, team));
    if (step.refused) throw CaseFailure(refusal(options, step));
    const PstdPlan plan = plan_of(c, options, grid, step.per_frame, team.size());
    std::optional<Setup> setup;
    together(team, [&] { setup = setup_of(c, options, grid, plan); });
    Stepper<Real> stepper(*setup, team);
    std::optional<typename PstdMarch<Real>::Outputs> outputs;
    together(team, [&] {
        outputs.emplace(typename PstdMarch<Real>::Outputs{
            .frames = Frames(c, frame_places(c, options, grid), stepper.slabs()),
            .volumes = DisplacementVolumes(c, grid, stepper.slabs()),
            .sensor = {}});
    });
    observer.begin(outputs->frames.slab());
    if (!c.record.volumes_s.empty()) observer.volume_levels(outputs->volumes->levels_m());
    PstdMarch<Real> field(c, step.per_frame, stepper, *outputs, "displacement_u_z", team);
    if (engines::march(field, c.time.frames * step.per_frame, observer, checkpoints,
                       case_work(c, grid, plan), began) == engines::MarchEnd::stopped)
        return;
    observer.solved({.notes = notes_of_case(c, step, plan),
                     .steps = stepper.steps(),
                     .warnings = engines::warnings_of(step_choices(options, step))});
}

} // namespace

const StepChoice& PstdEngine::step_of(const Case& c, engines::ChoiceLimit limit) const {
    const auto& options = std::get<PstdOptions>(c.solver);
    if (!step_ || step_->first != c)
        step_.emplace(
            c, choose_step(c, options, extremes_of_grid(c, options, case_grid(c, options), limit)));
    return step_->second;
}

engines::Resources PstdEngine::resources(const Case& c, int ranks) const {
    const auto& options = std::get<PstdOptions>(c.solver);
    if (c.study()) return study_resources(c, ranks);
    const CaseGrid grid = case_grid(c, options);
    // A specified step needs no limits of the grid.
    const StepChoice step = options.time_step_s ? choose_step(c, options, {}) : step_of(c);
    const PstdPlan plan = plan_of(c, options, grid, step.per_frame, ranks);
    engines::Resources all{.arrays = arrays_of(plan, ranks),
                           .work = engines::parts_of(case_work(c, grid, plan)),
                           .useful_ranks =
                               static_cast<int>(std::min(grid.points[0], grid.points[1]))};
    if (!c.record.volumes_s.empty())
        all.written_B = engines::volumes_B(c, static_cast<double>(grid.levels));
    return all;
}

std::vector<std::string> PstdEngine::choices(const Case& c) const {
    const auto& options = std::get<PstdOptions>(c.solver);
    if (c.study()) return study_notes(c);
    const StepChoice& step = step_of(c);
    return notes_of_case(c, step, plan_of(c, options, case_grid(c, options), step.per_frame, 1));
}

engines::StepChooser PstdEngine::step_chooser(const Case& c) const {
    if (c.study() || !varies_laterally(c.scene().medium) ||
        std::get<PstdOptions>(c.solver).time_step_s)
        return {};
    return [&](engines::ChoiceLimit limit) { return step_of(c, limit).step_s; };
}

engines::StepRefinement PstdEngine::half_the_step(const Case& c) const {
    auto options = std::get<PstdOptions>(c.solver);
    const double step_s = 0.5 * options.time_step_s.value_or(step_of(c).step_s);
    options.time_step_s = step_s;
    return {.options = options,
            .change = fmt::format("half the time step, {:.4g} us", 1e6 * step_s)};
}

void PstdEngine::run(const Case& c, const Comm& team, engines::Observer& observer,
                     engines::Checkpoints* checkpoints) {
    const auto& options = std::get<PstdOptions>(c.solver);
    if (c.study()) return run_study(c, team, observer, checkpoints);
    if (options.precision == Precision::single_precision)
        run_with<float>(c, options, team, observer, checkpoints);
    else
        run_with<double>(c, options, team, observer, checkpoints);
}

} // namespace shearwake::pstd
