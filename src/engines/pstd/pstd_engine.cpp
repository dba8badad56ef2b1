#include "engines/pstd/pstd_engine.hpp"

#include "base/error.hpp"
#include "engines/pstd/case_load.hpp"
#include "engines/pstd/case_step.hpp"
#include "engines/pstd/displacement_volumes.hpp"
#include "engines/pstd/study_run.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
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

/// u_z of the surface grid at the measured depths.
class Frames {
public:
    Frames(const Case& c, const PstdOptions& options, const CaseGrid& grid, const Slabs& slabs)
        : c_(c), grid_(grid), slabs_(slabs), slab_(domain_slab(c, grid, slabs)),
          plane_m_(static_cast<std::size_t>(slabs.rows())) {
        const bool rings = options.top == PstdTop::nothing && options.load == PstdLoad::traction;
        std::size_t planes = 1;
        if (!c.record.volumes_s.empty()) planes = static_cast<std::size_t>(grid.levels);
        for (const double depth_m : c.measure.depths_m) {
            weights_.push_back(depth_weights(depth_m, grid.spacing_m, rings));
            planes = std::max(planes, weights_.back().size());
        }
        u_z_.emplace(Field::uz, slabs, grid.surface - 1, static_cast<std::ptrdiff_t>(planes));
    }
    const Slab& slab() const { return slab_; }
    Displacement& displacement() { return *u_z_; }

    /// Collective.
    void give(std::ptrdiff_t number, Observer& observer, const Comm& team) {
        if (!u_z_->finite(team))
            throw FieldDiverges(fmt::format("the field of engine \"pstd\" is not finite at frame "
                                            "{}: a smaller solver.pstd.time_step_us may help",
                                            number));
        const std::ptrdiff_t ny = slabs_.ny(),
                             first = slab_.x_start + grid_.first_x - slabs_.x_start();
        for (std::size_t d = 0; d < weights_.size(); ++d) {
            u_z_->sum(weights_[d], plane_m_);
            const double* values =
                plane_m_.data() + (slab_.x_count > 0 ? first * ny + grid_.first_y : 0);
            observer.frame({.number = number,
                            .depth = d,
                            .u_z_m = View2<const double>(values, slab_.x_count, c_.domain.ny, ny)});
        }
    }

private:
    const Case& c_;
    CaseGrid grid_;
    Slabs slabs_;
    Slab slab_;
    std::vector<std::vector<double>> weights_; // of each depth
    std::optional<Displacement> u_z_;
    std::vector<double> plane_m_;
};

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
        frames.emplace(c, options, grid, stepper.slabs());
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
    Estimate e;
    e.memory_per_rank_B = 60e6 + per_point * points / ranks;
    e.seconds = points * static_cast<double>(c.time.frames * step.per_frame) *
                (lossy ? 90e-9 : 55e-9) * (single ? 0.6 : 1.0);
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
