// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/pstd_march.hpp"

#include "engines/pstd/scheme/work_kinds.hpp"

namespace shearwake::pstd {

template <class Real>
void PstdMarch<Real>::advance() {
    stepper_.step();
    {
        const engines::Timed columns(of_column);
        outputs_.frames.displacement().add(stepper_);
    }
    const engines::Timed kept(of_volume);
    if (outputs_.volumes) outputs_.volumes->add(stepper_);
    if (outputs_.sensor) outputs_.sensor->add(stepper_);
}

template <class Real>
void PstdMarch<Real>::give(engines::Observer& observer) {
    if (stepper_.steps() % per_frame_ != 0) return;
    const std::ptrdiff_t frames = stepper_.steps() / per_frame_;
    if (frames > case_.time.frames) return; // a study may continue after the last frame
    {
        const engines::Timed given(of_frame);
        outputs_.frames.give(frames - 1, observer, team_);
    }
    if (!outputs_.volumes) return;
    const engines::Timed kept(of_volume);
    if (const auto snapshot = engines::snapshot_at(case_, frames))
        outputs_.volumes->give(*snapshot, outputs_.frames.displacement(), observer, team_);
}

template <class Real>
void PstdMarch<Real>::save(StateWriter& state) const {
    stepper_.save(state);
    outputs_.frames.displacement().save(state, displacement_);
    if (outputs_.volumes) outputs_.volumes->save(state);
    if (outputs_.sensor) outputs_.sensor->save(state);
}

template <class Real>
void PstdMarch<Real>::restore(const StateReader& state) {
    stepper_.restore(state);
    outputs_.frames.displacement().restore(state, displacement_);
    if (outputs_.volumes) outputs_.volumes->restore(state);
    if (outputs_.sensor) outputs_.sensor->restore(state);
}

template class PstdMarch<double>;
template class PstdMarch<float>;

} // namespace shearwake::pstd
