// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stepper.hpp"

#include <cmath>

namespace shearwake::spectral {

Stepper::Stepper(RigidPlan bodies, const DepthMesh& mesh, const fft::SlabTransform& slabs,
                 double step_s, const Comm& team, std::ptrdiff_t per_frame)
    : state_(std::move(bodies), mesh, slabs, step_s, team) {
    if (per_frame > 0) {
        auto output = make_output(state_, per_frame);
        output_ = output.get();
        stages_.push_back(std::move(output));
    }
    const CellExtent cells = state_.field.cells().extent(&state_.team);
    if (state_.field.variation().iterates)
        box_ = box_grid(state_.c, mesh,
                        extent_of(state_.c.scene.medium, state_.c.domain).with(cells), step_s);
    auto sponge = make_sponge(state_);
    BoxStages in_box;
    if (box_) in_box = make_box_stages(state_, *box_);
    auto pencils = box_ ? std::move(in_box.pencils) : make_pencils(state_, *sponge);
    stages_.push_back(std::move(sponge));
    stages_.push_back(std::move(pencils));
    stages_.push_back(make_energy(state_));
    if (!state_.bodies->empty()) stages_.push_back(make_constraint(state_));
    if (box_) stages_.push_back(std::move(in_box.variation));
    if (state_.varies() && !box_) stages_.push_back(make_variation(state_));
}

void Stepper::advance() {
    for (const auto& stage : stages_)
        stage->advance();
    state_.end_step();
}

void Stepper::finish(engines::Observer& observer) {
    if (!output_ || !output_->needs_next_step()) return;
    advance();
    output_->emit_earlier(observer);
}

std::vector<engines::Allocation> Stepper::arrays() const {
    std::vector<engines::Allocation> all;
    for (const auto& stage : stages_)
        for (engines::Allocation& array : stage->arrays())
            all.push_back(std::move(array));
    return all;
}

void Stepper::save(StateWriter& state) const {
    state.put("step", static_cast<double>(state_.step));
    for (const auto& stage : stages_)
        stage->save(state);
}

void Stepper::restore(const StateReader& state) {
    state_.step = std::lround(state.get("step"));
    state_.statistics.steps = state_.step;
    for (const auto& stage : stages_)
        stage->restore(state);
}

} // namespace shearwake::spectral
