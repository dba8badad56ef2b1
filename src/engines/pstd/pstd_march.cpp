// SPDX-License-Identifier: BSD-3-Clause
#include "engines/march.hpp"
#include "engines/pstd/make_scheme.hpp"
#include "engines/pstd/pstd_engine.hpp"
#include "parallel/agree.hpp"

#include <optional>

namespace shearwake::pstd {
namespace {

Setup setup_of(const PstdRun& run, const Comm& team) {
    std::optional<Setup> setup;
    together(team, [&] { setup = run.setup(); });
    return std::move(*setup);
}

/// u_z at the measured depths for each frame, and displacements for each snapshot.
class PstdMarch : public engines::Marching {
public:
    /// Stores references, which must outlive this object. Collective.
    PstdMarch(const Case& c, const PstdPlan& plan, const PstdRun& run, const Comm& team)
        : case_(c), per_frame_(plan.per_frame), team_(team),
          scheme_(make_scheme(setup_of(run, team), plan.precision, plan.device, team)),
          watch_(energy_watch()) {
        together(team, [&] {
            frames_.emplace(c, plan.places, *scheme_);
            volumes_.emplace(c, run.grid, *scheme_);
        });
    }

    void begin(engines::Observer& observer) const {
        observer.begin(frames_->slab());
        if (!case_.record.volumes_s.empty()) observer.volume_levels(volumes_->levels_m());
    }
    std::ptrdiff_t step() const override { return scheme_->steps(); }
    void advance() override {
        scheme_->step();
        if (watch_.due(step())) {
            add_work(watch_);
            watched_work_J_ = scheme_->work_J();
            watch_.check(step(), scheme_->kinetic_J() / area_m2());
        }
        frames_->displacement().add();
        volumes_->add();
    }
    void emit(engines::Observer& observer) override {
        if (step() % per_frame_ != 0) return;
        const std::ptrdiff_t frames = step() / per_frame_;
        frames_->emit(frames - 1, observer, team_);
        if (const auto snapshot = engines::snapshot_at(case_, frames))
            volumes_->emit(*snapshot, frames_->displacement(), observer, team_);
    }
    void save(StateWriter& state) const override {
        scheme_->save(state);
        engines::EnergyWatch watch = watch_;
        add_work(watch);
        watch.save(state);
        frames_->displacement().save(state, "displacement_u_z");
        volumes_->save(state);
    }
    void restore(const StateReader& state) override {
        scheme_->restore(state);
        watch_.restore(state);
        frames_->displacement().restore(state, "displacement_u_z");
        volumes_->restore(state);
    }
    void finish(engines::SolverReport report, engines::Observer& observer) {
        report.steps = step();
        observer.solved(report);
    }

private:
    // With velocities v half a step before and after the stresses s, the scheme preserves
    //     E = 1/2 v-.M v+ + 1/2 s.S s.
    // Let r be the step relative to the largest stable one. In E the mean of v- and v+ has its full
    // kinetic energy, and s at least 1 - r^2 of its elastic energy (1 - r with viscosity alone).
    // Therefore the kinetic energy of v- is at most E/(1 - r), 20 E at the default r = 0.95.
    engines::EnergyWatch energy_watch() const {
        return {team_,
                scheme_->slabs().grid.dt_s,
                {.most_1 = 20.0,
                 .advice = "the time step is probably unstable; a smaller "
                           "solver.pstd.time_step_us may help"}};
    }
    double area_m2() const {
        const auto& grid = scheme_->slabs().grid;
        return static_cast<double>(grid.points[0] * grid.points[1]) * grid.spacing_m[0] *
               grid.spacing_m[1];
    }
    /// Adds the work since the last check.
    void add_work(engines::EnergyWatch& watch) const {
        watch.add_work((scheme_->work_J() - watched_work_J_) / area_m2());
    }

    const Case& case_;
    std::ptrdiff_t per_frame_;
    Comm team_;
    std::unique_ptr<Scheme> scheme_;
    engines::EnergyWatch watch_;
    double watched_work_J_ = 0.0; // the part of scheme_->work_J() that watch_ has
    std::optional<Frames> frames_;
    std::optional<DisplacementVolumes> volumes_;
};

} // namespace

void run_plan(const Case& c, const PstdPlan& plan, const PstdRun& run, const Comm& team,
              engines::Observer& observer, engines::Checkpoints* checkpoints) {
    PstdMarch field(c, plan, run, team);
    field.begin(observer);
    if (engines::march(field, static_cast<std::ptrdiff_t>(plan.steps), observer, checkpoints) ==
        engines::MarchEnd::complete)
        field.finish(run.report, observer);
}

} // namespace shearwake::pstd
