// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/pstd_engine.hpp"

#include "base/error.hpp"
#include "engines/pstd/scene/case_load.hpp"
#include "engines/pstd/scene/case_step.hpp"

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
                 std::ptrdiff_t per_frame) {
    const double d_m = c.domain.spacing_m;
    const Medium& medium = c.scene.medium;
    const Absorption absorption = is_lossy(medium) ? Absorption::kelvin_voigt : Absorption::none;
    const Grid nodes{
        grid.points, {d_m, d_m, d_m}, c.time.interval_s / static_cast<double>(per_frame)};
    return {.grid = nodes,
            .pml = absorbing_layer(c, options),
            .steps = static_cast<double>(c.time.frames * per_frame),
            .absorption = absorption,
            .precision = options.precision,
            .device = {options.device, options.device_number},
            .uneven = varies_laterally(medium),
            .coefficients = varying_coefficients(
                {.density = varies(medium, &Body::density_kg_m3, &MaterialMap::density_kg_m3),
                 .speeds = varies(medium, &Body::c_s_m_s, &MaterialMap::c_s_m_s) ||
                           varies(medium, &Body::c_p_m_s, &MaterialMap::c_p_m_s),
                 .viscosity = varies(medium, &Body::viscosity_Pa_s, &MaterialMap::viscosity_Pa_s)},
                absorption),
            .source_nodes = most_source_nodes(c, options),
            .places = frame_places(c, options, grid),
            .per_frame = per_frame,
            .levels = c.record.volumes_s.empty() ? 0 : grid.levels};
}

std::vector<std::string> notes_of_case(const Case& c, const StepChoice& step,
                                       const PstdPlan& plan) {
    auto notes = engines::notes_of(choices(c, std::get<PstdOptions>(c.solver), step));
    notes.push_back(note_of(plan));
    return notes;
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
    const CaseGrid grid = case_grid(c, options);
    // A specified step needs no limits of the grid.
    const StepChoice step = options.time_step_s ? choose_step(c, options, {}) : step_of(c);
    return resources_of(c, plan_of(c, options, grid, step.per_frame), ranks);
}

std::vector<std::string> PstdEngine::choices(const Case& c) const {
    const auto& options = std::get<PstdOptions>(c.solver);
    const StepChoice& step = step_of(c);
    return notes_of_case(c, step, plan_of(c, options, case_grid(c, options), step.per_frame));
}

engines::StepChooser PstdEngine::step_chooser(const Case& c) const {
    if (!varies_laterally(c.scene.medium) || std::get<PstdOptions>(c.solver).time_step_s) return {};
    return [&](engines::ChoiceLimit limit) { return step_of(c, limit).step_s; };
}

engines::StepRefinement PstdEngine::refine_time_step(const Case& c) const {
    auto options = std::get<PstdOptions>(c.solver);
    const double step_s = 0.5 * options.time_step_s.value_or(step_of(c).step_s);
    options.time_step_s = step_s;
    return {.options = options,
            .change = fmt::format("half the time step, {:.4g} us", 1e6 * step_s)};
}

void PstdEngine::run(const Case& c, const Comm& team, engines::Observer& observer,
                     engines::Checkpoints* checkpoints) {
    const auto& options = std::get<PstdOptions>(c.solver);
    const CaseGrid grid = case_grid(c, options);
    const StepChoice step = choose_step(c, options, extremes_of_grid(c, options, grid, team));
    if (step.refused) throw CaseFailure(refusal(options, step));
    const PstdPlan plan = plan_of(c, options, grid, step.per_frame);
    run_plan(c, plan,
             {.setup = [&] { return setup_of(c, options, grid, plan); },
              .grid = grid,
              .report = {.notes = notes_of_case(c, step, plan),
                         .warnings = engines::warnings_of(step_choices(options, step))}},
             team, observer, checkpoints);
}

} // namespace shearwake::pstd
