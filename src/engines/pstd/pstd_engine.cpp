// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/pstd_engine.hpp"

#include "base/error.hpp"
#include "engines/pstd/pstd_plan.hpp"
#include "engines/pstd/pstd_march.hpp"
#include "engines/pstd/scene/case_load.hpp"
#include "engines/pstd/scene/case_step.hpp"
#include "engines/pstd/scheme/stepper.hpp"
#include "engines/pstd/study_run.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace shearwake::pstd {
namespace {

Setup setup_of(const Case& c, const PstdOptions& options, const CaseGrid& grid, double step_s) {
    Setup setup;
    const double d_m = c.domain.spacing_m;
    setup.grid = {grid.points, {d_m, d_m, d_m}, step_s};
    setup.pml = absorbing_layer(c, options);
    setup.material = [=, &c](Node node) { return material_at(c, options, grid, node); };
    setup.absorption = is_lossy(c.scene().medium) ? Absorption::kelvin_voigt : Absorption::none;
    setup.sources = {load_source(c, options, grid, step_s)};
    return setup;
}

FramePlaces frame_places(const Case& c, const PstdOptions& options, const CaseGrid& grid) {
    const SurfacePlane surface =
        options.top == PstdTop::nothing && options.load == PstdLoad::traction ? SurfacePlane::rings
                                                                              : SurfacePlane::kept;
    FramePlaces places{
        .first_x = grid.first_x, .first_y = grid.first_y, .first_z = grid.surface - 1};
    if (!c.record.volumes_s.empty()) places.planes = grid.levels;
    for (const double depth_m : c.measure.depths_m) {
        places.weights.push_back(depth_weights(depth_m, grid.spacing_m, surface));
        places.planes = std::max(places.planes, std::ssize(places.weights.back()));
    }
    return places;
}

/// The step that `run` uses, with the limits of the grid. Not collective.
StepChoice step_of(const Case& c, const PstdOptions& options) {
    return choose_step(c, options, extremes_of_grid(c, options, case_grid(c, options)));
}

/// Steps per frame. A specified step needs no limits of the grid.
std::ptrdiff_t steps_per_frame(const Case& c, const PstdOptions& options) {
    return options.time_step_s ? choose_step(c, options, {}).per_frame
                               : step_of(c, options).per_frame;
}

PstdPlan plan_of(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                 std::ptrdiff_t per_frame) {
    return {.points = static_cast<double>(grid.points[0]) * static_cast<double>(grid.points[1]) *
                      static_cast<double>(grid.points[2]),
            .steps = static_cast<double>(c.time.frames * per_frame),
            .absorption = is_lossy(c.scene().medium) ? Absorption::kelvin_voigt : Absorption::none,
            .precision = options.precision,
            .uneven = varies_laterally(c.scene().medium)};
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

template <class Real>
void run_with(const Case& c, const PstdOptions& options, const Comm& team,
              engines::Observer& observer, engines::Checkpoints* checkpoints) {
    const auto began = Clock::now();
    const CaseGrid grid = case_grid(c, options);
    const StepChoice step = choose_step(c, options, extremes_of_grid(c, options, grid, team));
    if (step.refused) throw CaseFailure(refusal(options, step));
    std::optional<Setup> setup;
    together(team, [&] { setup = setup_of(c, options, grid, step.step_s); });
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
    const engines::MarchWork work = case_work(c, grid, plan_of(c, options, grid, step.per_frame));
    if (engines::march(field, c.time.frames * step.per_frame, observer, checkpoints, work, began) ==
        engines::MarchEnd::stopped)
        return;
    observer.solved({.notes = engines::notes_of(pstd::choices(c, options, step)),
                     .steps = stepper.steps(),
                     .warnings = engines::warnings_of(step_choices(options, step))});
}

} // namespace

engines::Resources PstdEngine::resources(const Case& c, int ranks) const {
    const auto& options = std::get<PstdOptions>(c.solver);
    if (c.study()) return study_resources(c, ranks);
    const CaseGrid grid = case_grid(c, options);
    const PstdPlan plan = plan_of(c, options, grid, steps_per_frame(c, options));
    engines::Resources all{.arrays = arrays_of_stepper(plan, ranks),
                           .work = engines::parts_of(case_work(c, grid, plan)),
                           .useful_ranks =
                               static_cast<int>(std::min(grid.points[0], grid.points[1]))};
    const double points = plan.points / ranks;
    all.arrays.push_back({"materials of nodes at the start", sizeof(NodeMaterial) * points});
    if (c.record.volumes_s.empty()) return all;
    all.arrays.push_back({"displacement of nodes", 3.0 * sizeof(double) * points});
    all.written_B = engines::volumes_B(c, static_cast<double>(grid.levels));
    return all;
}

std::vector<std::string> PstdEngine::choices(const Case& c) const {
    const auto& options = std::get<PstdOptions>(c.solver);
    if (c.study()) return {};
    return engines::notes_of(pstd::choices(c, options, step_of(c, options)));
}

bool PstdEngine::probes_step(const Case& c) const {
    return !c.study() && varies_laterally(c.scene().medium) &&
           !std::get<PstdOptions>(c.solver).time_step_s;
}

double PstdEngine::probed_step_s(const Case& c) const {
    return step_of(c, std::get<PstdOptions>(c.solver)).step_s;
}

Case PstdEngine::with_step(const Case& c, double step_s) const {
    Case given = c;
    std::get<PstdOptions>(given.solver).time_step_s = step_s;
    return given;
}

engines::StepRefinement PstdEngine::half_the_step(const Case& c) const {
    auto options = std::get<PstdOptions>(c.solver);
    const double step_s = 0.5 * options.time_step_s.value_or(probed_step_s(c));
    options.time_step_s = step_s;
    return {.options = options,
            .change = fmt::format("half the time step, {:.4g} us", 1e6 * step_s),
            .order = 2.0};
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
