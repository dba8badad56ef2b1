// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stages.hpp"

namespace shearwake::spectral {
namespace {

/// One pass over the pencils, in which everything happens while the factor of a pencil is in the
/// cache: d = B^-1 (f - K u - C (u - u-)/dt + E^T s) with the explicit stress s of the elastic
/// bodies, and u- becomes 2u - u- + d.
class PencilStage : public Stage {
public:
    PencilStage(StepState& state, Sponge& sponge) : Stage(state), sponge_(sponge) {}

    void advance() override {
        s_.load.sample(s_.step);
        if (s_.varies()) {
            s_.find_stress();
            s_.planes.set(s_.stress);
        }
        s_.energy.clear();
        const bool is_damped = sponge_.acts_in_pass();
        s_.each_pencil({}, [&](const Pencil& p) {
            if (is_damped) sponge_.damp_in_pass(p);
            advance(p);
        });
        if (s_.varies()) s_.planes.get(s_.change);
    }

    std::vector<engines::Allocation> arrays() const override { return s_.arrays(); }
    void save(StateWriter& state) const override { s_.save_displacement(state); }
    void restore(const StateReader& state) override { s_.restore_displacement(state); }

private:
    void advance(const Pencil& p) {
        const double scale = s_.scale();
        const Block* u = s_.u(p);
        Block *before = s_.u_before(p), *force = s_.scratch.data();
        Block pressure[parts];
        s_.put_forces(p, u, before, force, pressure, s_.factor(p.at));
        s_.add_planes_force(p, force);
        s_.solve(p, force);
        s_.add_work(p, scale, u, before, force, pressure);
        s_.put_strain(p, force);
        s_.kernels.advance(s_.size(), scale, u, force, before);
        if (!s_.bodies->empty()) s_.bodies->evaluate(p.row, p.block, before);
    }

    Sponge& sponge_;
};

} // namespace

std::unique_ptr<Stage> make_pencils(StepState& state, Sponge& sponge) {
    return std::make_unique<PencilStage>(state, sponge);
}

} // namespace shearwake::spectral
