#include "engines/pstd/pstd_engine.hpp"

#include "base/error.hpp"
#include "engines/pstd/case_load.hpp"
#include "engines/pstd/case_step.hpp"
#include "engines/pstd/displacement_volumes.hpp"
#include "engines/pstd/estimate.hpp"
#include "engines/pstd/frames.hpp"
#include "engines/pstd/study_run.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace shearwake {
namespace {

using namespace pstd;

Setup setup_of(const Case& c, const PstdOptions& options, const CaseGrid& grid, double step_s) {
    Setup setup;
    const double d_m = c.domain.spacing_m;
    setup.grid = {grid.points, {d_m, d_m, d_m}, step_s};
    setup.pml = absorbing_layer(c, options);
    setup.material = [=, &c](Node node) { return material_at(c, options, grid, node); };
    setup.absorption = is_lossy(c.medium) ? Absorption::kelvin_voigt : Absorption::none;
    setup.sources = {load_source(c, options, grid, step_s)};
    return setup;
}

FramePlaces frame_places(const Case& c, const PstdOptions& options, const CaseGrid& grid) {
    const bool rings = options.top == PstdTop::nothing && options.load == PstdLoad::traction;
    FramePlaces places{
        .first_x = grid.first_x, .first_y = grid.first_y, .first_z = grid.surface - 1};
    if (!c.record.volumes_s.empty()) places.planes = grid.levels;
    for (const double depth_m : c.measure.depths_m) {
        places.weights.push_back(depth_weights(depth_m, grid.spacing_m, rings));
        places.planes = std::max(places.planes, std::ssize(places.weights.back()));
    }
    return places;
}

/// The snapshot that a frame is, if any.
std::optional<std::size_t> snapshot_of(const Case& c, std::ptrdiff_t frame) {
    for (std::size_t i = 0; i < c.record.volumes_s.size(); ++i)
        if (std::llround(c.record.volumes_s[i] / c.time.interval_s) == frame + 1) return i;
    return {};
}

template <class Real>
void run_with(const Case& c, const PstdOptions& options, const Comm& team, Observer& observer,
              Checkpoints* checkpoints) {
    const CaseGrid grid = case_grid(c, options);
    const StepChoice step = choose_step(c, options, extremes_of_grid(c, options, grid, team));
    if (step.refused) throw CaseFailure(refusal(options, step));
    std::optional<Setup> setup;
    together(team, [&] { setup = setup_of(c, options, grid, step.step_s); });
    Stepper<Real> stepper(*setup, team);
    std::optional<Frames> frames;
    std::optional<DisplacementVolumes> volumes;
    together(team, [&] {
        frames.emplace(c, frame_places(c, options, grid), stepper.slabs());
        volumes.emplace(c, grid, stepper.slabs());
    });
    Displacement& u_z = frames->displacement();
    observer.begin(frames->slab());
    if (!c.record.volumes_s.empty()) observer.volume_levels(volumes->levels_m());
    if (checkpoints)
        checkpoints->restore([&](StateReader& state) {
            stepper.restore(state);
            u_z.restore(state, "displacement_u_z");
            volumes->restore(state);
            observer.restore(state);
        });
    const std::ptrdiff_t steps = c.time.frames * step.per_frame;
    while (stepper.steps() < steps) {
        stepper.step();
        u_z.add(stepper);
        volumes->add(stepper);
        if (stepper.steps() % step.per_frame == 0) {
            const std::ptrdiff_t frame = stepper.steps() / step.per_frame - 1;
            frames->give(frame, observer, team);
            if (const auto snapshot = snapshot_of(c, frame))
                volumes->give(*snapshot, u_z, observer, team);
        }
        if (!checkpoints || stepper.steps() == steps || !checkpoints->due()) continue;
        checkpoints->save([&](StateWriter& state) {
            stepper.save(state);
            u_z.save(state, "displacement_u_z");
            volumes->save(state);
            observer.save(state);
        });
        if (checkpoints->stop()) return;
    }
    observer.solved({.notes = choice_notes(c, options, step), .steps = stepper.steps()});
}

} // namespace

Estimate PstdEngine::estimate(const Case& c, int ranks) const {
    const auto& options = std::get<PstdOptions>(c.solver);
    if (options.study) return estimate_study(c, ranks);
    const CaseGrid grid = case_grid(c, options);
    const StepChoice step = choose_step(c, options, extremes_of_layers(c, options));
    const double points = static_cast<double>(grid.points[0]) *
                          static_cast<double>(grid.points[1]) * static_cast<double>(grid.points[2]);
    const bool lossy = is_lossy(c.medium);
    const bool single = options.precision == Precision::single_precision;
    const double bytes = single ? 4.0 : 8.0;
    // 9 totals, up to 15 parts, gradients there and back, coefficients; the nodes at the start.
    const double values = lossy ? 9.0 + 15.0 + 15.0 : 9.0 + 15.0 + 6.0;
    const double coefficients = c.medium.bodies.empty() && !c.medium.map ? 0.0 : lossy ? 13.0 : 8.0;
    const double kept = c.record.volumes_s.empty() ? 0.0 : 3.0 * sizeof(double);
    const double per_point = bytes * (values + coefficients) + sizeof(NodeMaterial) + kept;
    Estimate e = estimate_steps(
        {points, static_cast<double>(c.time.frames * step.per_frame), lossy, single});
    e.memory_per_rank_B = 60e6 + per_point * points / ranks;
    e.useful_ranks = static_cast<int>(std::min(grid.points[0], grid.points[1]));
    return e;
}

std::vector<std::string> PstdEngine::choices(const Case& c) const {
    const auto& options = std::get<PstdOptions>(c.solver);
    if (options.study) return {};
    return choice_notes(c, options, choose_step(c, options, extremes_of_layers(c, options)));
}

void PstdEngine::run(const Case& c, const Comm& team, Observer& observer,
                     Checkpoints* checkpoints) {
    const auto& options = std::get<PstdOptions>(c.solver);
    if (options.study) return run_study(c, team, observer, checkpoints);
    if (options.precision == Precision::single_precision)
        run_with<float>(c, options, team, observer, checkpoints);
    else
        run_with<double>(c, options, team, observer, checkpoints);
}

} // namespace shearwake
