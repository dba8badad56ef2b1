// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stages.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace shearwake::spectral {
namespace {

/// Compares the kinetic energy before the step with the work of the load so far, and takes the
/// larger one of the step as the reference of the iterations.
class EnergyStage : public Stage {
public:
    using Stage::Stage;

    void advance() override {
        if (s_.energy.watch.due(s_.step))
            s_.energy.watch.check(s_.step, 0.5 * s_.energy.kinetic.mine());
        s_.energy.watch.add_work(s_.scale() * s_.energy.work.mine());
        if (s_.field.variation().iterates)
            s_.energy.reference = std::max(s_.energy.kinetic.team_sum(s_.team),
                                           std::abs(s_.energy.work.team_sum(s_.team)));
    }
    std::vector<engines::Allocation> arrays() const override { return {}; } // a number per ky
    void save(StateWriter& state) const override { s_.energy.watch.save(state); }
    void restore(const StateReader& state) override { s_.energy.watch.restore(state); }
};

/// The part of the energy that the cells add to that of the background, per area.
double lateral_energy_J_m2(StepState& s) {
    // Work arrays of a step are free between two steps.
    StepState::Values &difference = s.change, &stress = s.stress;
    for (std::size_t i = 0; i < s.strain.size(); ++i)
        difference[i] = s.strain[i] - s.strain_before[i];
    const auto inner = [](const StepState::Values& a, const StepState::Values& b) {
        return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    };
    double lateral = 0.0;
    if (s.field.variation().iterates) {
        for (std::size_t point = 0; point < s.field.points(); ++point)
            s.field.implicit(point, difference, stress);
        lateral += 0.5 * inner(difference, stress);
    }
    s.field.stress(s.strain_before, s.strain_before, 0.0, stress); // K u-
    lateral += 0.5 * inner(s.strain, stress);
    const StepState::Values rest(s.field.size(), 0.0);
    s.field.stress(rest, difference, 1.0 / s.step_s, stress); // -C v/dt
    lateral += 0.25 * inner(difference, stress);
    return lateral * s.per_point();
}

} // namespace

std::unique_ptr<Stage> make_energy(StepState& state) {
    return std::make_unique<EnergyStage>(state);
}

// With v+ = u+ - u and the implicit operator A the scheme preserves
//     E = 1/2 v+.(A - C/(2 dt)) v+ + 1/2 u.K u+.
// Each step adds the work f.(u+ - u-)/2 and removes the losses by viscosity and drag.
EnergyBalance energy_of(StepState& s) {
    const std::ptrdiff_t size = s.size();
    const double rate = 1.0 / s.step_s;
    fft::AlignedVector<Block> memory;
    double kinetic = 0.0, implicit = 0.0, stored = 0.0, viscous = 0.0, lateral = 0.0;
    together(s.team, [&] {
        memory.assign(static_cast<std::size_t>(3 * size), Block{});
        if (s.varies()) lateral = lateral_energy_J_m2(s);
    });
    Block *change = memory.data(), *force = change + size, *zero = force + size;
    s.each_pencil(
        {.strain = false, .markers = false}, [](std::ptrdiff_t) {},
        [&](const Pencil& p) {
            const Block *now = s.u(p), *before = s.u_before(p);
            const Block k = s.vectors.waves(p.row, p.block).k;
            const Counted counted = s.vectors.counted(p.row, p.block);
            const auto inner = [&](const Block* a, const Block* b) {
                return sum_of(s.kernels.product(size, a, b, counted.part));
            };
            s.kernels.difference(size, 1.0, now, before, change);
            kinetic += 0.5 * sum_of(s.vertical.twice_kinetic(rate, now, before, counted.part));
            std::fill_n(force, size, Block{});
            s.vertical.add_internal_force(k, 0.0, before, before, force);
            stored -= inner(force, now); // -K u-
            std::fill_n(force, size, Block{});
            s.vertical.add_internal_force(k, rate, zero, change, force);
            viscous += inner(force, change); // C v/dt
            implicit += sum_of(s.vertical.implicit_form(s.factor(p.at), change, counted.part));
        });
    s.energy.watch.check(s.step, kinetic);
    const double bodies = s.team.is_root() ? s.bodies->twice_kinetic_J_m2() : 0.0;
    const double mine = 0.5 * (implicit - 0.5 * viscous + stored + bodies) + lateral;
    const double area_m2 = s.c.domain.extent_x_m() * s.c.domain.extent_y_m();
    return {area_m2 * s.team.sum(mine), area_m2 * s.energy.watch.work_J_m2()};
}

} // namespace shearwake::spectral
