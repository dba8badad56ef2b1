// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/pstd_march.hpp"

#include "engines/pstd/scheme/stepper.hpp"

namespace shearwake::pstd {

// With velocities v half a step before and after the stresses s, the scheme preserves
//     E = 1/2 v-.M v+ + 1/2 s.S s.
// Let r be the step relative to the largest stable one. In E the mean of v- and v+ has its full
// kinetic energy, and s at least 1 - r^2 of its elastic energy (1 - r with viscosity alone).
// Therefore the kinetic energy of v- is at most E/(1 - r), 20 E at the default r = 0.95.
template <class Real>
engines::EnergyWatch PstdMarch<Real>::energy_watch() const {
    const bool study = case_.study() != nullptr;
    return {team_,
            stepper_.slabs().grid.dt_s,
            {.most_1 = 20.0,
             .advice = study
                           ? "the time step is probably unstable; a smaller kgrid.dt of the study "
                             "may help"
                           : "the time step is probably unstable; a smaller "
                             "solver.pstd.time_step_us may help"}};
}

template <class Real>
void PstdMarch<Real>::watch() {
    const auto& grid = stepper_.slabs().grid;
    const double area_m2 = static_cast<double>(grid.points[0] * grid.points[1]) *
                           grid.spacing_m[0] * grid.spacing_m[1];
    const double work_J = stepper_.work_J();
    watch_.add_work((work_J - watched_work_J_) / area_m2);
    watched_work_J_ = work_J;
    const std::ptrdiff_t step = stepper_.steps();
    if (!watch_.due(step)) return;
    // E is at most 1 + r times the sum of the kinetic and the elastic energy.
    if (static_cast<double>(step - watch_.interval()) < stepper_.unknown_until())
        watch_.accept(step, 2.0 * (stepper_.kinetic_J() + stepper_.elastic_J()) / area_m2);
    else
        watch_.check(step, stepper_.kinetic_J() / area_m2);
}

template <class Real>
void PstdMarch<Real>::advance() {
    stepper_.step();
    watch();
    outputs_.frames.displacement().add(stepper_);
    if (outputs_.volumes) outputs_.volumes->add(stepper_);
    if (outputs_.sensor) outputs_.sensor->add(stepper_, team_);
}

template <class Real>
void PstdMarch<Real>::emit(engines::Observer& observer) {
    if (stepper_.steps() % per_frame_ != 0) return;
    const std::ptrdiff_t frames = stepper_.steps() / per_frame_;
    if (frames > case_.time.frames) return; // a study may continue after the last frame
    outputs_.frames.emit(frames - 1, observer, team_);
    if (!outputs_.volumes) return;
    if (const auto snapshot = engines::snapshot_at(case_, frames))
        outputs_.volumes->emit(*snapshot, outputs_.frames.displacement(), observer, team_);
}

template <class Real>
void PstdMarch<Real>::save(StateWriter& state) const {
    stepper_.save(state);
    watch_.save(state);
    outputs_.frames.displacement().save(state, displacement_);
    if (outputs_.volumes) outputs_.volumes->save(state);
    if (outputs_.sensor) outputs_.sensor->save(state);
}

template <class Real>
void PstdMarch<Real>::restore(const StateReader& state) {
    stepper_.restore(state);
    watch_.restore(state);
    outputs_.frames.displacement().restore(state, displacement_);
    if (outputs_.volumes) outputs_.volumes->restore(state);
    if (outputs_.sensor) outputs_.sensor->restore(state);
}

template class PstdMarch<double>;
template class PstdMarch<float>;

} // namespace shearwake::pstd
